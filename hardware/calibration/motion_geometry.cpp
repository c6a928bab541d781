// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/motion_geometry.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "core/units.h"
#include "hardware/calibration/rotation.h"

namespace glint {
namespace {

constexpr int kMinPoses = 5;

double degrees(double angle) {
  return angle * kDegPerRad;
}

}  // namespace

MotionGeometry motion_geometry(std::span<const Eigen::Isometry3d> base_from_flange) {
  MotionGeometry motion{.num_poses = static_cast<int>(base_from_flange.size())};
  if (base_from_flange.empty()) {
    return motion;
  }
  const Eigen::Matrix3d mean = mean_pose(base_from_flange).linear();
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Isometry3d& pose : base_from_flange) {
    const Eigen::Vector3d turn = rotation_vector_rad(mean.transpose() * pose.linear());
    sum += turn * turn.transpose();
    for (const Eigen::Isometry3d& other : base_from_flange) {
      motion.largest_rotation_rad = std::max(motion.largest_rotation_rad,
                                             angle_rad(pose.linear().transpose() * other.linear()));
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(sum / motion.num_poses);
  motion.spread_rad = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().reverse();
  return motion;
}

std::string refusal_of(const MotionGeometry& motion) {
  if (motion.num_poses < kMinPoses) {
    return fmt::format(
        "{} pictures with robot poses, at least {} are needed", motion.num_poses, kMinPoses);
  }
  if (motion.largest_rotation_rad < kRadPerDeg) {
    return fmt::format(
        "the robot turned by at most {:.2f} degrees between pictures: without rotation the "
        "translation of the hand-eye is unknown, turn it by 20 to 30 degrees about two axes",
        degrees(motion.largest_rotation_rad));
  }
  if (motion.spread_rad[1] < 0.3 * kRadPerDeg) {
    return fmt::format(
        "the robot turned about one axis only ({:.2f} degrees rms about the second one): the place "
        "along that axis is unknown, turn it about a second axis, too",
        degrees(motion.spread_rad[1]));
  }
  return {};
}

std::vector<std::string> warnings_of(const MotionGeometry& motion) {
  std::vector<std::string> warnings;
  if (motion.largest_rotation_rad < 5.0 * kRadPerDeg) {
    warnings.push_back(fmt::format(
        "the robot turned by at most {:.1f} degrees between pictures, 20 to 30 are wanted",
        degrees(motion.largest_rotation_rad)));
  } else if (motion.spread_rad[1] < 2.0 * kRadPerDeg) {
    warnings.push_back(fmt::format(
        "the robot turned almost about one axis: {:.1f} degrees rms about the first, {:.1f} about "
        "the second one",
        degrees(motion.spread_rad[0]),
        degrees(motion.spread_rad[1])));
  }
  return warnings;
}

}  // namespace glint
