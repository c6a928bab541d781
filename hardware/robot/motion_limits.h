// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/config/keys.h"

namespace glint {

/// What a robot may do at most; the keys of [limits] in a cell file. None of them has a default
/// that a file could rely on: each must be given, as only a person in front of the cell can know
/// it.
struct MotionLimits {
  double tool_speed_mm_s = 0.0;  ///< of every point of the tool and of every link
  double tool_acceleration_mm_s2 = 0.0;
  double joint_speed_rad_s = 0.0;
  double joint_acceleration_rad_s2 = 0.0;
  std::vector<double> box_min_mm;  ///< of the space, in the robot's base, that no part of the arm
  std::vector<double> box_max_mm;  ///< may leave; the tool included
  /// Straight lines keep singularity_measure() above it.
  double min_singularity_measure = 0.005;
};

/// Asks for every key but min_singularity_measure.
void visit_keys(KeyVisitor& keys, MotionLimits& limits);

}  // namespace glint
