// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a robot's poses can tell a hand-eye at all.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace glint {

/// How far the flange turned between the pictures.
struct MotionGeometry {
  int num_poses = 0;
  double largest_rotation_rad = 0.0;  ///< between any two poses
  /// Spread (standard deviation) of the rotations about their first, second and third principal
  /// axis. About one axis alone the place along it stays unknown.
  Eigen::Vector3d spread_rad = Eigen::Vector3d::Zero();
};

MotionGeometry motion_geometry(std::span<const Eigen::Isometry3d> base_from_flange);

/// What is missing for any answer: fewer than 5 poses, rotations about one axis (second spread
/// under 0.3 degrees), hardly any rotation (largest under 1 degree). Empty: nothing.
std::string refusal_of(const MotionGeometry& motion);

/// What makes an answer weak: rotations under 5 degrees, hardly any about a second axis.
std::vector<std::string> warnings_of(const MotionGeometry& motion);

}  // namespace glint
