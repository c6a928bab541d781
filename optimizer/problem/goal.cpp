// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/problem/goal.h"

#include <cmath>

#include "core/config/keys.h"
#include "core/text.h"

namespace glint {

void check(const Goal& goal) {
  std::vector<std::string> errors;
  if (goal.objective.name.empty()) {
    errors.emplace_back("objective: a score to maximise or minimise is needed");
  }
  for (const Constraint& constraint : goal.constraints) {
    const std::string where = "constraint on \"" + constraint.name + "\": ";
    if (!constraint.min && !constraint.max) {
      errors.emplace_back(where + "needs min, max or both");
    }
    if (constraint.min && constraint.max && *constraint.min > *constraint.max) {
      errors.emplace_back(where + "min " + shortest(*constraint.min) + " is above max " +
                          shortest(*constraint.max));
    }
    if (!std::isfinite(constraint.min.value_or(0.0)) ||
        !std::isfinite(constraint.max.value_or(0.0))) {
      errors.emplace_back(where + "limits must be finite");
    }
    if (!(constraint.weight > 0.0) || !std::isfinite(constraint.weight)) {
      errors.emplace_back(where + "weight must be above 0");
    }
  }
  throw_if_any(errors);
}

}  // namespace glint
