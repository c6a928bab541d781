// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/problem/goal.h"

#include <cmath>

#include "core/config/keys.h"
#include "core/text.h"

namespace glint {

void check(const Goal& goal) {
  std::vector<Problem> errors;
  if (goal.objective.name.empty()) {
    errors.push_back({.key = "objective", .text = "a score to maximise or minimise is needed"});
  }
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
