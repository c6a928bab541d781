// SPDX-License-Identifier: GPL-3.0-or-later
//
// When an arm stands still enough for a picture, and where it stands then.
#pragma once

#include <optional>

#include "hardware/robot/robot_state.h"

namespace glint {

/// Averages over at least 25 packages of a standstill.
struct StillPose {
  JointVector joints_rad = JointVector::Zero();
  Eigen::Isometry3d base_from_tcp = Eigen::Isometry3d::Identity();  ///< mm
  double timestamp_s = 0.0;  ///< of the controller, of the last package
  int packages = 0;
};

/// No joint faster than 1e-3 rad/s for 100 ms, and each within 1e-4 rad of its target; a package
/// that breaks this, or has a readiness_problem(), begins anew: an arm without power or with a hand
/// at it stands nowhere that could be relied on.
class StillPoseRule {
 public:
  static constexpr int kMinPackages = 25;
  static constexpr double kMinSeconds = 0.1;
  static constexpr double kSpeedRadS = 1e-3;
  static constexpr double kTargetRad = 1e-4;

  void add(const RobotState& state);

  /// None: not still for long enough yet.
  std::optional<StillPose> pose() const;

 private:
  void restart();

  int packages_ = 0;
  double first_s_ = 0.0;
  double last_s_ = 0.0;
  JointVector sum_rad_ = JointVector::Zero();
  Eigen::Vector3d sum_mm_ = Eigen::Vector3d::Zero();
  Eigen::Vector4d sum_rotation_ = Eigen::Vector4d::Zero();  ///< quaternions, all of one sign
};

}  // namespace glint
