// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/study_goal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/config/key_writer.h"
#include "core/text.h"
#include "metrics/scores.h"
#include "studies/definition/scene_scores.h"

namespace glint {
namespace {

using Kind = ConfigNode::Kind;

constexpr std::array<std::string_view, 3> kChoiceRules = {"knee", "weights", "aspirations"};

bool is_direction(const std::string& name) {
  return name == "maximise" || name == "minimise";
}

/// What stands in the table of an objective and does not belong there.
std::string other_names(const ConfigNode& table) {
  std::string names;
  for (const std::string& name : table.names) {
    if (!is_direction(name)) {
      names += fmt::format("{}\"{}\"", names.empty() ? "; it holds " : ", ", name);
    }
  }
  return names;
}

/// [objective]: one score and its direction.
void read_one_objective(Study& study, const ConfigNode& table, std::vector<Problem>& errors) {
  const bool is_good = table.is_table() && table.items.size() == 1 &&
                       is_direction(table.names[0]) && table.items[0].kind == Kind::kText;
  if (!is_good) {
    errors.push_back({.place = table.place,
                      .key = "objective",
                      .text = "must hold either maximise or minimise = \"name of a score\"" +
                              other_names(table)});
    return;
  }
  study.goal.objective = {.name = table.items[0].text,
                          .is_maximised = table.names[0] == "maximise"};
  study.has_objective = true;
}

/// One table of [[objective]]. @return nothing where it is wrong, which is told
std::optional<Objective> read_listed(const ConfigNode& table,
                                     const std::string& path,
                                     std::vector<Problem>& errors) {
  Objective objective;
  const std::size_t before = errors.size();
  const auto fail = [&](const ConfigNode& where, const std::string& key, const std::string& text) {
    errors.push_back(
        {.place = where.place, .key = key.empty() ? path : joined_path(path, key), .text = text});
  };
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const std::string& name = table.names[i];
    const ConfigNode& item = table.items[i];
    if (is_direction(name) && item.kind == Kind::kText && objective.name.empty()) {
      objective.name = item.text;
      objective.is_maximised = name == "maximise";
    } else if (name == "reference" && item.is_number() && std::isfinite(item.number)) {
      objective.reference = item.number;
    } else if (name == "aspiration" && item.is_number() && std::isfinite(item.number)) {
      objective.aspiration = item.number;
    } else if (name == "weight" && item.is_number() && std::isfinite(item.number) &&
               item.number > 0.0) {
      objective.weight = item.number;
    } else {
      fail(item,
           name,
           "must be one maximise or minimise = \"name of a score\", reference, aspiration = "
           "numbers, weight = a number > 0");
    }
  }
  if (objective.name.empty() && errors.size() == before) {
    fail(table, "", "needs maximise or minimise = \"name of a score\"");
  }
  return errors.size() == before ? std::optional(objective) : std::nullopt;
}

/// [[objective]]: several.
void read_objectives(Study& study, const ConfigNode& list, std::vector<Problem>& errors) {
  std::vector<Objective> objectives;
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const std::string path = fmt::format("objective.{}", i);
    if (!list.items[i].is_table()) {
      errors.push_back({.place = list.items[i].place,
                        .key = path,
                        .text = "must be a table, like [[objective]]"});
    } else if (auto objective = read_listed(list.items[i], path, errors)) {
      if (std::ranges::find(objectives, objective->name, &Objective::name) != objectives.end()) {
        errors.push_back(
            {.kind = Problem::Kind::kRelation,
             .place = list.items[i].place,
             .key = path,
             .text = fmt::format("\"{}\" is an objective twice; allowed: each score once",
                                 objective->name)});
      }
      objectives.push_back(std::move(*objective));
    }
  }
  if (list.items.size() < 2) {
    errors.push_back({.place = list.place,
                      .key = "objective",
                      .text = "[[objective]] is for several, there is one; allowed: two or more, "
                              "or [objective]"});
  }
  if (objectives.size() != list.items.size() || objectives.size() < 2) {
    return;
  }
  study.goal.objective = objectives.front();
  study.goal.more_objectives.assign(objectives.begin() + 1, objectives.end());
  study.has_objective = true;
}

void visit_choice(KeyVisitor& keys, ChoiceRule& rule) {
  keys.choice("by",
              rule,
              kChoiceRules,
              "which design of several objectives is the best: the knee (nearest to the best of "
              "all at once), the smallest weighted sum of what is given up, or the one that "
              "reaches the aspirations or misses them least");
}

void read_choice(Study& study, std::vector<Problem>& errors) {
  const ConfigNode* table = study.root.find("choice");
  if (table == nullptr) {
    return;
  }
  if (!has_several_objectives(study.goal)) {
    errors.push_back({.kind = Problem::Kind::kRelation,
                      .place = table->place,
                      .key = "choice",
                      .text = "chooses between several objectives; allowed only with two or more "
                              "[[objective]] tables"});
    return;
  }
  KeyReader reader(table, "choice", errors);
  visit_choice(reader, study.goal.choice);
  reader.report_unknown();
}

/// What a goal of several objectives does not go with.
void check_several(const Study& study, std::vector<Problem>& errors) {
  const Place place = study.root.find("objective")->place;
  const auto fail = [&](const std::string& key, const std::string& text) {
    const ConfigNode* node = study.root.at_path(key);
    errors.push_back({.kind = Problem::Kind::kRelation,
                      .place = node != nullptr ? node->place : place,
                      .key = key,
                      .text = text});
  };
  if (!study.has_search()) {
    fail("objective",
         "several objectives need [variables]: they are for a search; allowed: [objective] with "
         "the one that designs are compared by");
  }
  if (study.budget.target) {
    fail("budget.target",
         "works with a single objective only, this study has several; allowed: budget.stall, "
         "evaluations without a gain of hypervolume");
  }
  if (study.budget.race) {
    fail("budget.race",
         "works with a single objective only, this study has several; not needed: the designs of "
         "the front are scored again with fresh random numbers in any case");
  }
  if (study.root.at_path("prototypes.front") != nullptr) {
    fail("prototypes.front",
         "the folder front/ of a run holds the designs of several objectives' front; allowed: any "
         "other name");
  }
  const std::string& algorithm = study.search.algorithm;
  if (!takes_several_objectives(algorithm)) {
    fail("search.algorithm",
         fmt::format("\"{}\" works with a single objective only, this study has {}; allowed: "
                     "\"auto\", \"gp\", \"nsga2\", \"nspso\", \"sobol\", \"random\"",
                     algorithm,
                     num_objectives(study.goal)));
  }
  try {
    check(study.goal);
  } catch (const ConfigError& error) {
    for (const Problem& problem : error.problems()) {
      fail(problem.key, problem.text);
    }
  }
}

void read_constraints(Study& study, std::vector<Problem>& errors) {
  const ConfigNode* table = study.root.find("constraints");
  if (table == nullptr) {
    return;
  }
  for (std::size_t i = 0; i < table->names.size(); ++i) {
    const ConfigNode& item = table->items[i];
    Constraint constraint{.name = table->names[i]};
    bool is_good = item.is_table();
    for (std::size_t k = 0; is_good && k < item.names.size(); ++k) {
      const std::string& name = item.names[k];
      is_good = item.items[k].is_number() && std::isfinite(item.items[k].number);
      const double value = item.items[k].number;
      if (name == "min") {
        constraint.min = value;
      } else if (name == "max") {
        constraint.max = value;
      } else if (name == "weight") {
        constraint.weight = value;
      } else {
        is_good = false;
      }
    }
    const auto fail = [&](std::string text) {
      errors.push_back({.place = item.place,
                        .context = "constraints",
                        .key = constraint.name,
                        .text = std::move(text)});
    };
    if (!is_good || !(constraint.min || constraint.max) || constraint.weight <= 0.0) {
      fail("must be { min = .. } or { max = .. } (min <= max, weight > 0)");
      continue;
    }
    if (constraint.min && constraint.max && *constraint.min > *constraint.max) {
      fail(fmt::format("min {} is above max {}, which no design can keep",
                       shortest(*constraint.min),
                       shortest(*constraint.max)));
      continue;
    }
    study.goal.constraints.push_back(std::move(constraint));
  }
}

/// An evenly white picture is perfectly homogeneous and shows nothing: a study that maximises
/// homogeneity gets the limits that keep it from winning, unless it sets its own.
void add_default_constraints(Study& study) {
  constexpr double kMaxClippedShare = 0.01;
  constexpr double kMinCnr = 3.0;
  const auto begins = [](const std::string& name, const char* prefix) {
    return name.rfind(prefix, 0) == 0;
  };
  const auto has = [&](const char* prefix) {
    return std::ranges::any_of(study.goal.constraints, [&](const Constraint& constraint) {
      return begins(constraint.name, prefix);
    });
  };
  const std::vector<Objective> objectives = objectives_of(study.goal);
  const bool is_about_homogeneity =
      study.has_objective && std::ranges::any_of(objectives, [&](const Objective& objective) {
        return begins(objective.name, "homogeneity.");
      });
  if (!is_about_homogeneity) {
    return;
  }
  if (!has("homogeneity.clipped_share")) {
    study.goal.constraints.push_back(
        {.name = "homogeneity.clipped_share", .max = kMaxClippedShare});
  }
  const bool has_defects_in_goal =
      has("defects.") || std::ranges::any_of(objectives, [&](const Objective& objective) {
        return begins(objective.name, "defects.");
      });
  if (!defect_labels(study.scene).empty() && !has_defects_in_goal) {
    study.goal.constraints.push_back({.name = "defects.min_cnr", .min = kMinCnr});
  }
}

}  // namespace

void read_goal(Study& study, std::vector<Problem>& errors) {
  const std::size_t before = errors.size();
  const ConfigNode* objective = study.root.find("objective");
  if (objective != nullptr && objective->is_array()) {
    read_objectives(study, *objective, errors);
  } else if (objective != nullptr) {
    read_one_objective(study, *objective, errors);
  } else if (study.has_search()) {
    errors.push_back({.place = study.root.find("variables")->place,
                      .key = "objective",
                      .text = "a search needs [objective] with maximise or minimise = \"score\""});
  }
  read_constraints(study, errors);
  if (errors.size() == before) {
    read_choice(study, errors);
  }
  add_default_constraints(study);
  if (errors.size() == before && has_several_objectives(study.goal)) {
    check_several(study, errors);
  }
  const std::string& algorithm = study.search.algorithm;
  if (errors.size() == before && needs_several_objectives(algorithm) &&
      !has_several_objectives(study.goal)) {
    const ConfigNode* node = study.root.at_path("search.algorithm");
    errors.push_back({.kind = Problem::Kind::kRelation,
                      .place = node != nullptr ? node->place : Place{},
                      .key = "search.algorithm",
                      .text = fmt::format(
                          "\"{}\" needs several objectives, there is one; allowed: [[objective]] "
                          "twice or more, or \"auto\", \"gp\", \"cmaes\" and others",
                          algorithm)});
  }
}

void check_goal(const Study& study, std::vector<Problem>& errors) {
  const std::vector<std::string> labels = defect_labels(study.scene);
  const std::vector<std::string> groups = group_names(study.scene);
  const bool chooses_lights = std::ranges::any_of(
      study.space.variables, [](const Variable& one) { return one.name == "lighting_use"; });
  const auto check_name =
      [&](const std::string& path, const std::string& name, const Place& place) {
        std::string problem = unknown_score(name, labels, groups);
        problem += problem.empty() ? missing_as_goal(name) : "";
        problem += problem.empty() ? missing_by_paths(study.scene, name) : "";
        problem += problem.empty() ? missing_by_reference(study.scene, name) : "";
        problem += problem.empty() ? missing_by_cell(study.scene, name) : "";
        problem += problem.empty() ? missing_by_lighting(study.scene, name, chooses_lights) : "";
        if (!problem.empty()) {
          errors.push_back(
              {.place = place, .key = path, .text = fmt::format("\"{}\" {}", name, problem)});
        }
      };
  if (study.has_objective) {
    const ConfigNode& objective = *study.root.find("objective");
    const bool is_list = objective.is_array();
    for (std::size_t i = 0; i < (is_list ? objective.items.size() : 1); ++i) {
      const ConfigNode& table = is_list ? objective.items[i] : objective;
      const std::string path = is_list ? fmt::format("objective.{}", i) : "objective";
      const char* direction = table.find("maximise") != nullptr ? "maximise" : "minimise";
      const ConfigNode& name = *table.find(direction);
      check_name(joined_path(path, direction), name.text, name.place);
    }
  }
  const ConfigNode* constraints = study.root.find("constraints");
  for (std::size_t i = 0; constraints != nullptr && i < constraints->names.size(); ++i) {
    check_name("constraints", constraints->names[i], constraints->items[i].place);
  }
}

std::vector<KeyRow> goal_keys() {
  std::vector<KeyRow> rows;
  const auto add = [&](const char* path, const char* kind, const char* allowed, const char* doc) {
    rows.push_back(
        {.path = path, .kind = kind, .allowed = allowed, .default_text = "none", .doc = doc});
  };
  add("objective.maximise", "text", "the name of a score", "what the search makes large");
  add("objective.minimise", "text", "the name of a score", "what the search makes small");
  add("objective.reference",
      "number",
      "any",
      "of [[objective]], in the score's unit: the worst value of interest, from which the "
      "hypervolume is measured; "
      "without it the worst of the initial design");
  add("objective.aspiration",
      "number",
      "any",
      "of [[objective]], better than the reference: the value hoped for, for choice.by = "
      "\"aspirations\"");
  add("objective.weight",
      "number",
      "> 0",
      R"(of [[objective]]: its part in choice.by = "weights" and "aspirations"; 1 without it)");
  rows.back().range = Range::positive();
  ChoiceRule rule = ChoiceRule::kKnee;
  KeyLister lister("choice", rows);
  visit_choice(lister, rule);
  add("constraints.\"score\"",
      "table",
      "{ min, max, weight }",
      "limits that a score of a feasible design keeps; a study that optimises homogeneity has "
      "homogeneity.clipped_share <= 0.01 and, with defects, defects.min_cnr >= 3 unless it sets "
      "its own");
  return rows;
}

}  // namespace glint
