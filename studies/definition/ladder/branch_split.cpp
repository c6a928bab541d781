// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/branch_split.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/text.h"

namespace glint {
namespace {

/// Of the rungs of a scene: "paths", or the level of one that follows none.
std::set<std::string> kinds_of(const SceneSettings& scene, const KeptKeys& kept) {
  std::set<std::string> kinds;
  for (const RenderRung& rung : render_ladder(scene, kept)) {
    kinds.insert(rung.is_noisy ? "paths" : rung.level);
  }
  return kinds;
}

/// How many kinds of ladders a design has with the values of a choice; values with which it cannot
/// be built do not count.
std::size_t num_kinds(const Study& study,
                      const BranchChoice& choice,
                      Point design,
                      const KeptKeys& kept) {
  std::set<std::set<std::string>> kinds;
  for (std::size_t value = 0; value < choice.values.size(); ++value) {
    design[choice.variable] = static_cast<double>(value);
    try {
      const Overrides overrides = overrides_of(study, canonical(study.space, design));
      kinds.insert(kinds_of(scene_with(study, overrides), kept));
    } catch (const ConfigError&) {  // the trial replaces such a design, too
    }
  }
  return kinds.size();
}

/// The most of them in any branch; of the baseline where there are none.
std::size_t most_kinds(const Study& study,
                       const BranchChoice& choice,
                       const std::optional<BranchSplit>& split,
                       const KeptKeys& kept) {
  if (!split) {
    return num_kinds(study, choice, baseline_point(study), kept);
  }
  std::size_t most = 0;
  for (std::size_t branch = 0; branch < split->values.size(); ++branch) {
    most = std::max(most, num_kinds(study, choice, baseline_of(study, *split, branch), kept));
  }
  return most;
}

bool may_be_split(const Variable& variable) {
  return variable.kind == Variable::Kind::kChoice && variable.when_name.empty() &&
         variable.choices.size() > 1 && variable.choices.size() <= kMaxBranchValues;
}

/// Of all choices of the study.
std::vector<BranchChoice> choices_of(const Study& study) {
  std::vector<BranchChoice> choices;
  for (std::size_t i = 0; i < study.space.variables.size(); ++i) {
    const Variable& variable = study.space.variables[i];
    if (variable.kind == Variable::Kind::kChoice) {
      choices.push_back({.variable = i, .name = variable.name, .values = variable.choices});
    }
  }
  return choices;
}

bool has_choice(const std::optional<BranchSplit>& split, const BranchChoice& choice) {
  return split && std::ranges::find(split->choices, choice.variable, &BranchChoice::variable) !=
                      split->choices.end();
}

/// The split with one more choice, that of the most kinds. Empty: there is none that makes no more
/// than kMaxBranches of it.
std::optional<BranchSplit> split_further(const Study& study,
                                         const std::optional<BranchSplit>& split,
                                         const KeptKeys& kept) {
  std::optional<BranchChoice> found;
  const std::size_t branches = split ? split->values.size() : 1;
  std::size_t most = 1;
  for (const BranchChoice& choice : choices_of(study)) {
    if (!may_be_split(study.space.variables[choice.variable]) || has_choice(split, choice) ||
        branches * choice.values.size() > kMaxBranches) {
      continue;
    }
    if (const std::size_t kinds = most_kinds(study, choice, split, kept); kinds > most) {
      most = kinds;
      found = choice;
    }
  }
  if (!found) {
    return std::nullopt;
  }
  std::vector<BranchChoice> choices = split ? split->choices : std::vector<BranchChoice>();
  choices.push_back(*found);
  std::ranges::sort(choices, {}, &BranchChoice::variable);
  return split_by(std::move(choices));
}

/// A search by derivatives takes closed forms alone.
bool may_have_branches(const Study& study) {
  return study.has_search() && !wants_derivatives(study);
}

/// As it stands in the list of choices.
std::string choice_text(const ConfigNode& node) {
  if (node.kind == ConfigNode::Kind::kBoolean) {
    return node.boolean ? "true" : "false";
  }
  return node.text;
}

}  // namespace

std::size_t BranchSplit::branch_of(const Point& point) const {
  std::size_t branch = 0;
  for (const BranchChoice& choice : choices) {
    GLINT_CHECK(choice.variable < point.size(), "a point has a value of each variable");
    const auto last = static_cast<double>(choice.values.size() - 1);
    const double value = std::clamp(std::round(point[choice.variable]), 0.0, last);
    branch = branch * choice.values.size() + static_cast<std::size_t>(value);
  }
  return branch;
}

std::vector<std::size_t> BranchSplit::values_in(std::size_t branch) const {
  std::vector<std::size_t> found(choices.size());
  for (std::size_t i = choices.size(); i-- > 0;) {
    found[i] = branch % choices[i].values.size();
    branch /= choices[i].values.size();
  }
  return found;
}

std::string BranchSplit::label(std::size_t branch) const {
  const std::vector<std::size_t> which = values_in(branch);
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    parts.push_back(fmt::format("{} = {}", choices[i].name, choices[i].values[which[i]]));
  }
  return join(parts, ", ");
}

BranchSplit split_by(std::vector<BranchChoice> choices) {
  BranchSplit split = {.choices = std::move(choices), .name = {}, .values = {}};
  std::size_t branches = 1;
  std::vector<std::string> names;
  for (const BranchChoice& choice : split.choices) {
    names.push_back(choice.name);
    branches *= choice.values.size();
  }
  split.name = join(names, ", ");
  for (std::size_t branch = 0; branch < branches; ++branch) {
    const std::vector<std::size_t> which = split.values_in(branch);
    std::vector<std::string> values;
    for (std::size_t i = 0; i < which.size(); ++i) {
      values.push_back(split.choices[i].values[which[i]]);
    }
    split.values.push_back(join(values, ", "));
  }
  return split;
}

std::optional<BranchSplit> one_choice_split(const Study& study) {
  return may_have_branches(study) ? split_further(study, std::nullopt, kept_keys(study.root))
                                  : std::nullopt;
}

std::optional<BranchSplit> branch_split(const Study& study) {
  std::optional<BranchSplit> split = one_choice_split(study);
  const KeptKeys kept = kept_keys(study.root);
  while (split) {
    const std::optional<BranchSplit> further = split_further(study, split, kept);
    if (!further) {
      break;
    }
    split = further;
  }
  return split;
}

std::vector<std::string> choices_in_common(const Study& study,
                                           const std::optional<BranchSplit>& split) {
  std::vector<std::string> names;
  if (!may_have_branches(study)) {
    return names;
  }
  const KeptKeys kept = kept_keys(study.root);
  for (const BranchChoice& choice : choices_of(study)) {
    if (!has_choice(split, choice) && most_kinds(study, choice, split, kept) > 1) {
      names.push_back(choice.name);
    }
  }
  return names;
}

Point in_branch(const Study& study, const BranchSplit& split, std::size_t branch, Point point) {
  const std::vector<std::size_t> which = split.values_in(branch);
  for (std::size_t i = 0; i < which.size(); ++i) {
    point[split.choices[i].variable] = static_cast<double>(which[i]);
  }
  return canonical(study.space, point);
}

Point baseline_of(const Study& study, const BranchSplit& split, std::size_t branch) {
  return in_branch(study, split, branch, baseline_point(study));
}

std::optional<std::size_t> branch_of(const Study& study,
                                     const BranchSplit& split,
                                     const Overrides& overrides) {
  std::size_t branch = 0;
  for (const BranchChoice& choice : split.choices) {
    const auto given = std::ranges::find(overrides, choice.name, &Overrides::value_type::first);
    const std::string text = choice_text(
        given != overrides.end() ? given->second : *study.resolved.at_path(choice.name));
    const auto found = std::ranges::find(choice.values, text);
    if (found == choice.values.end()) {
      return std::nullopt;
    }
    branch =
        branch * choice.values.size() + static_cast<std::size_t>(found - choice.values.begin());
  }
  return branch;
}

const RenderRung& SearchRungs::of(const Point& point) const {
  return rungs[split ? split->branch_of(point) : 0];
}

std::string SearchRungs::name() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < rungs.size(); ++i) {
    names.push_back(split ? fmt::format("{}: {}", split->values[i], rungs[i].name) : rungs[i].name);
  }
  return join(names, "; ");
}

}  // namespace glint
