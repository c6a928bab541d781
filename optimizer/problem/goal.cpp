// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/problem/goal.h"

#include <cmath>
#include <set>

#include "core/config/keys.h"
#include "core/text.h"

namespace glint {

namespace {

void check_objective(const Objective& objective, std::vector<Problem>& errors) {
  const auto fail = [&](const std::string& text) {
    errors.push_back({.key = "objective", .text = objective.name + ": " + text});
  };
  if (objective.name.empty()) {
    errors.push_back({.key = "objective", .text = "a score to maximise or minimise is needed"});
    return;
  }
  if (!(objective.weight > 0.0) || !std::isfinite(objective.weight)) {
    fail("weight must be above 0");
  }
  if (!std::isfinite(objective.reference.value_or(0.0)) ||
      !std::isfinite(objective.aspiration.value_or(0.0))) {
    fail("reference and aspiration must be finite");
  }
  if (objective.reference && objective.aspiration) {
    const double lead = *objective.aspiration - *objective.reference;
    if (!(objective.is_maximised ? lead > 0.0 : lead < 0.0)) {
      fail("aspiration " + shortest(*objective.aspiration) + " must be " +
           (objective.is_maximised ? "above" : "below") + " the reference " +
           shortest(*objective.reference));
    }
  }
}

void check_objectives(const Goal& goal, std::vector<Problem>& errors) {
  const std::vector<Objective> objectives = objectives_of(goal);
  std::set<std::string> names;
  bool has_aspiration = false;
  for (const Objective& objective : objectives) {
    check_objective(objective, errors);
    has_aspiration = has_aspiration || objective.aspiration;
    if (!names.insert(objective.name).second) {
      errors.push_back({.key = "objective", .text = objective.name + ": is an objective twice"});
    }
  }
  if (goal.choice == ChoiceRule::kAspirations && !has_aspiration) {
    errors.push_back({.key = "choice.by",
                      .text =
                          "\"aspirations\" needs an objective with an aspiration; allowed without: "
                          "\"knee\", \"weights\""});
  }
}

}  // namespace

std::vector<Objective> objectives_of(const Goal& goal) {
  std::vector<Objective> all = {goal.objective};
  all.insert(all.end(), goal.more_objectives.begin(), goal.more_objectives.end());
  return all;
}

int num_objectives(const Goal& goal) {
  return 1 + static_cast<int>(goal.more_objectives.size());
}

void check(const Goal& goal) {
  std::vector<Problem> errors;
  check_objectives(goal, errors);
  for (const Constraint& constraint : goal.constraints) {
    const auto fail = [&](const std::string& text) {
      errors.push_back({.key = "constraint on \"" + constraint.name + "\"", .text = text});
    };
    if (!constraint.min && !constraint.max) {
      fail("needs min, max or both");
    }
    if (constraint.min && constraint.max && *constraint.min > *constraint.max) {
      fail("min " + shortest(*constraint.min) + " is above max " + shortest(*constraint.max));
    }
    if (!std::isfinite(constraint.min.value_or(0.0)) ||
        !std::isfinite(constraint.max.value_or(0.0))) {
      fail("limits must be finite");
    }
    if (!(constraint.weight > 0.0) || !std::isfinite(constraint.weight)) {
      fail("weight must be above 0");
    }
  }
  throw_if_any(errors);
}

}  // namespace glint
