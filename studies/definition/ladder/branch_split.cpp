// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/branch_split.h"

#include <algorithm>
#include <cmath>
#include <set>

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

/// How many kinds of ladders the baseline has with the values of a choice; values with which it
/// cannot be built do not count.
std::size_t num_kinds(const Study& study, const BranchSplit& split, const KeptKeys& kept) {
  std::set<std::set<std::string>> kinds;
  for (std::size_t branch = 0; branch < split.values.size(); ++branch) {
    try {
      const Point point = baseline_of(study, split, branch);
      kinds.insert(kinds_of(scene_with(study, overrides_of(study, point)), kept));
    } catch (const ConfigError&) {  // the trial replaces such a design, too
    }
  }
  return kinds.size();
}

bool may_be_split(const Variable& variable) {
  return variable.kind == Variable::Kind::kChoice && variable.when_name.empty() &&
         variable.choices.size() > 1 && variable.choices.size() <= kMaxBranches;
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
  GLINT_CHECK(variable < point.size(), "a point has a value of each variable");
  const auto last = static_cast<double>(values.size() - 1);
  return static_cast<std::size_t>(std::clamp(std::round(point[variable]), 0.0, last));
}

std::string BranchSplit::label(std::size_t branch) const {
  return fmt::format("{} = {}", name, values[branch]);
}

std::optional<BranchSplit> branch_split(const Study& study) {
  if (!study.has_search() || wants_derivatives(study)) {
    return std::nullopt;
  }
  const KeptKeys kept = kept_keys(study.root);
  std::optional<BranchSplit> found;
  std::size_t most = 1;
  for (std::size_t i = 0; i < study.space.variables.size(); ++i) {
    const Variable& variable = study.space.variables[i];
    if (!may_be_split(variable)) {
      continue;
    }
    const BranchSplit split = {.variable = i, .name = variable.name, .values = variable.choices};
    if (const std::size_t kinds = num_kinds(study, split, kept); kinds > most) {
      most = kinds;
      found = split;
    }
  }
  return found;
}

Point baseline_of(const Study& study, const BranchSplit& split, std::size_t branch) {
  Point point = baseline_point(study);
  point[split.variable] = static_cast<double>(branch);
  return canonical(study.space, point);
}

std::optional<std::size_t> branch_of(const Study& study,
                                     const BranchSplit& split,
                                     const Overrides& overrides) {
  const auto given = std::ranges::find(overrides, split.name, &Overrides::value_type::first);
  const std::string text =
      choice_text(given != overrides.end() ? given->second : *study.resolved.at_path(split.name));
  const auto found = std::ranges::find(split.values, text);
  return found != split.values.end()
             ? std::optional(static_cast<std::size_t>(found - split.values.begin()))
             : std::nullopt;
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
