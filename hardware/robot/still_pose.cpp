// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/still_pose.h"

namespace glint {

void StillPoseRule::restart() {
  *this = StillPoseRule();
}

void StillPoseRule::add(const RobotState& state) {
  const bool is_new = packages_ == 0 || state.timestamp_s > last_s_;
  const bool is_still =
      readiness_problem(state).empty() &&
      (state.actual_qd_rad_s.array().abs() < kSpeedRadS).all() &&
      ((state.actual_q_rad - state.target_q_rad).array().abs() < kTargetRad).all();
  if (!is_new || !is_still) {
    restart();
    return;
  }
  first_s_ = packages_ == 0 ? state.timestamp_s : first_s_;
  last_s_ = state.timestamp_s;
  sum_rad_ += state.actual_q_rad;
  sum_mm_ += state.base_from_tcp.translation();
  const Eigen::Vector4d turn = Eigen::Quaterniond(state.base_from_tcp.linear()).coeffs();
  sum_rotation_ += sum_rotation_.dot(turn) < 0.0 ? Eigen::Vector4d(-turn) : turn;
  ++packages_;
}

std::optional<StillPose> StillPoseRule::pose() const {
  if (packages_ < kMinPackages || last_s_ - first_s_ < kMinSeconds) {
    return std::nullopt;
  }
  StillPose pose = {
      .joints_rad = sum_rad_ / packages_, .timestamp_s = last_s_, .packages = packages_};
  pose.base_from_tcp.translation() = sum_mm_ / packages_;
  pose.base_from_tcp.linear() =
      Eigen::Quaterniond(Eigen::Vector4d(sum_rotation_.normalized())).toRotationMatrix();
  return pose;
}

}  // namespace glint
