// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/plan_check.h"

#include <fmt/format.h>

#include "hardware/planning/clearance.h"

namespace glint {

std::string obstruction(const PlanningCell& cell, const ViewPlan& plan) {
  const ClearanceCheck clearance(cell);
  for (const PlannedPath& path : plan.paths) {
    for (std::size_t i = 1; i < path.joints_rad.size(); ++i) {
      const JointVector& from_rad = path.joints_rad[i - 1];
      const JointVector& to_rad = path.joints_rad[i];
      const Clearance way = clearance.along(from_rad, to_rad);
      // Planning looked at it in one of both directions; at the margin they may differ.
      if (!way.is_free() && !clearance.along(to_rad, from_rad).is_free()) {
        return fmt::format("from {} to {}: {}", path.from, path.to, way.text);
      }
    }
  }
  return "";
}

}  // namespace glint
