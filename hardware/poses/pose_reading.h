// SPDX-License-Identifier: GPL-3.0-or-later
//
// A pose of the robot from its numbers, once what they mean is known.
#pragma once

#include <Eigen/Geometry>

#include "hardware/poses/pose_convention.h"

namespace glint {

/// As it is written, in its unit.
Eigen::Vector3d written_position(const WrittenPose& pose);

/// base_from_flange of one pose, in mm.
/// @param convention  resolved
/// @throws ConfigError with the place: no rotation (by how much), no unit quaternion
Eigen::Isometry3d base_from_flange(const WrittenPose& pose, const PoseConvention& convention);

}  // namespace glint
