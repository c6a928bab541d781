// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/rng.h"
#include "hardware/robot/kinematics/arm.h"

namespace glint {

/// Six angles in (-pi, pi), the same for the same index.
JointVector random_joints(std::uint64_t index);

/// Deltas as real arms have them: 1 mrad, 0.5 mm, and for joints 2 and 3 shifts along their axes.
ArmDeltas typical_deltas(ArmModel model);

/// Largest difference of an angle, whole turns not counted.
double joint_distance_rad(const JointVector& a, const JointVector& b);

}  // namespace glint
