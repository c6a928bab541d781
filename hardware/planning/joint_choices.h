// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which joints take the camera to a pose, and why none do.
#pragma once

#include <string>
#include <vector>

#include "hardware/planning/clearance.h"
#include "hardware/planning/view_plan.h"

namespace glint {

/// A branch of the inverse kinematics that may be taken.
struct JointChoice {
  std::vector<JointVector> turns_rad;  ///< the same pose with whole turns of joints; at least one
  double singularity = 0.0;
  double margin_mm = 0.0;
};

struct JointChoices {
  ViewOutcome outcome = ViewOutcome::kPlanned;  ///< how far the best branch came
  std::string reason;
  std::vector<JointChoice> accepted;  ///< at least one when planned
};

/// The joints turned by whole circles in every way that keeps them within the cell's limits,
/// nearest to the middle of the limits first.
std::vector<JointVector> turns_within(const PlanningCell& cell, const JointVector& joints_rad);

/// Why joints are too near a singular pose; empty: they are not. Joints 3 and 5 have to be turned
/// by min_joint_sine, and singularity_measure() has to reach the cell's limit.
std::string singular_text(const PlanningCell& cell, const JointVector& joints_rad);

/// Every branch, judged.
JointChoices choices_of(const PlanningCell& cell,
                        const ClearanceCheck& clearance,
                        const Eigen::Isometry3d& base_from_flange);

}  // namespace glint
