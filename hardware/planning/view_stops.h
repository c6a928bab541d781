// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which joints a view is taken with: branches that are accepted there and have a free way to a safe
// position.
#pragma once

#include <string>
#include <vector>

#include "hardware/planning/joint_choices.h"
#include "hardware/planning/route_map.h"

namespace glint {

/// Joints for one view.
struct StopChoice {
  std::size_t node = 0;  ///< of the RouteMap's legs
  double singularity = 0.0;
  double margin_mm = 0.0;
};

struct Stop {
  ViewOutcome outcome = ViewOutcome::kPlanned;
  std::string reason;
  std::vector<StopChoice> choices;  ///< at least one when planned
};

/// Tries branches in the order of the time that they are away from safe positions, each at those
/// whole turns that are nearest to them, and all other turns when none of these has a free way.
/// @param most  choices to be found at most; >= 1
Stop find_stop(const PlanningCell& cell,
               const ClearanceCheck& clearance,
               RouteMap& routes,
               const Eigen::Isometry3d& base_from_flange,
               std::size_t most);

}  // namespace glint
