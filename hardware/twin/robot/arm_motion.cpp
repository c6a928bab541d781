// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/arm_motion.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

constexpr double kSingularMeasure = 1e-3;
constexpr double kSlowest = 1e-6;  ///< speeds and accelerations of a script are at least so large

}  // namespace

ArmMotion::ArmMotion(const Arm& arm, const JointVector& joints_rad)
    : arm_(&arm), joints_rad_(joints_rad) {}

std::optional<JointVector> ArmMotion::goal_rad() const {
  if (const auto* joints = std::get_if<JointMotion>(&motion_)) {
    return joints->from_rad + joints->way_rad;
  }
  if (const auto* line = std::get_if<LineMotion>(&motion_)) {
    return line->goal_rad;
  }
  return is_moving() ? std::nullopt : std::optional(joints_rad_);
}

double ArmMotion::progress() const {
  return is_moving() && duration_s_ > 0.0 ? std::min(1.0, time_s_ / duration_s_) : 1.0;
}

void ArmMotion::start_joints(const JointVector& goal_rad, double speed, double acceleration) {
  const JointVector way_rad = goal_rad - joints_rad_;
  const Trapezoid leading(
      way_rad.cwiseAbs().maxCoeff(), std::max(speed, kSlowest), std::max(acceleration, kSlowest));
  motion_ = JointMotion{.from_rad = joints_rad_, .way_rad = way_rad, .leading = leading};
  time_s_ = 0.0;
  duration_s_ = leading.duration_s();
}

void ArmMotion::start_line(const Eigen::Isometry3d& flange_from_tcp,
                           const Eigen::Isometry3d& base_from_tcp,
                           double speed_mm_s,
                           double acceleration_mm_s2) {
  flange_from_tcp_ = flange_from_tcp;
  const Eigen::Isometry3d from = arm_->forward(joints_rad_) * flange_from_tcp;
  const double length_mm = line_length_mm(from, base_from_tcp);
  const Trapezoid along(
      length_mm, std::max(speed_mm_s, kSlowest), std::max(acceleration_mm_s2, kSlowest));
  LineMotion line = {
      .from = from, .to = base_from_tcp, .length_mm = length_mm, .along = along, .goal_rad = {}};
  time_s_ = 0.0;
  duration_s_ = along.duration_s();
  motion_ = line;
  line.goal_rad = end_of_line();
  motion_ = line;
}

std::optional<JointVector> ArmMotion::end_of_line() const {
  ArmMotion ahead = *this;
  const double step_s = duration_s_ / (100.0 + std::get<LineMotion>(motion_).length_mm);
  while (ahead.is_moving()) {
    if (!ahead.advance(step_s).empty()) {
      return std::nullopt;
    }
  }
  return ahead.joints_rad();
}

void ArmMotion::start_stop(double deceleration_rad_s2) {
  const double fastest = speed_rad_s_.cwiseAbs().maxCoeff();
  if (fastest == 0.0) {
    motion_ = std::monostate();
    return;
  }
  duration_s_ = fastest / std::max(deceleration_rad_s2, kSlowest);
  motion_ =
      StopMotion{.from_rad = joints_rad_, .speed_rad_s = speed_rad_s_, .duration_s = duration_s_};
  time_s_ = 0.0;
}

void ArmMotion::stand() {
  motion_ = std::monostate();
  flange_from_tcp_.setIdentity();
  speed_rad_s_.setZero();
  time_s_ = 0.0;
  duration_s_ = 0.0;
}

std::string ArmMotion::advance(double dt_s) {
  if (!is_moving()) {
    speed_rad_s_.setZero();
    return {};
  }
  const JointVector before_rad = joints_rad_;
  const double before_s = time_s_;
  time_s_ += dt_s;
  std::string problem;
  if (const auto* joints = std::get_if<JointMotion>(&motion_)) {
    const double length = joints->way_rad.cwiseAbs().maxCoeff();
    const double share = length > 0.0 ? joints->leading.at(time_s_) / length : 1.0;
    joints_rad_ = joints->from_rad + share * joints->way_rad;
  } else if (const auto* line = std::get_if<LineMotion>(&motion_)) {
    problem = advance_line(*line);
  } else if (const auto* stop = std::get_if<StopMotion>(&motion_)) {
    const double t = std::min(time_s_, stop->duration_s);
    joints_rad_ = stop->from_rad + stop->speed_rad_s * (t - 0.5 * t * t / stop->duration_s);
  }
  if (problem.empty() && joints_rad_.cwiseAbs().maxCoeff() > kJointLimitRad + 1e-9) {
    problem = "joint limit";
  }
  if (problem.empty()) {
    speed_rad_s_ = speed_after(before_rad, before_s);
  } else {
    joints_rad_ = before_rad;
    speed_rad_s_.setZero();
  }
  if (time_s_ >= duration_s_) {
    motion_ = std::monostate();
    speed_rad_s_.setZero();
  }
  return problem;
}

JointVector ArmMotion::speed_after(const JointVector& before_rad, double before_s) const {
  if (const auto* joints = std::get_if<JointMotion>(&motion_)) {
    const double length = joints->way_rad.cwiseAbs().maxCoeff();
    return length > 0.0 ? JointVector(joints->leading.speed_at(time_s_) / length * joints->way_rad)
                        : JointVector::Zero();
  }
  if (const auto* line = std::get_if<LineMotion>(&motion_)) {
    const double way = line->along.at(time_s_) - line->along.at(before_s);
    return way > 0.0 ? JointVector(line->along.speed_at(time_s_) / way * (joints_rad_ - before_rad))
                     : JointVector::Zero();
  }
  const auto& stop = std::get<StopMotion>(motion_);
  return std::max(0.0, 1.0 - time_s_ / stop.duration_s) * stop.speed_rad_s;
}

std::string ArmMotion::advance_line(const LineMotion& line) {
  if (time_s_ >= duration_s_ && line.goal_rad) {
    joints_rad_ =
        *line.goal_rad;  // not by Newton's method from elsewhere: the same to the last bit
    return {};
  }
  const double share = line.length_mm > 0.0 ? line.along.at(time_s_) / line.length_mm : 1.0;
  const Eigen::Isometry3d base_from_flange =
      pose_between(line.from, line.to, share) * flange_from_tcp_.inverse();
  const auto joints_rad = arm_->refined(base_from_flange, joints_rad_);
  if (!joints_rad || singularity_measure(arm_->jacobian(*joints_rad)) < kSingularMeasure) {
    return "singularity";
  }
  const JointVector near_rad = nearest_turns(*joints_rad, joints_rad_, 2.0 * kJointLimitRad);
  constexpr double kJumpRad = 0.3;
  if ((near_rad - joints_rad_).cwiseAbs().maxCoeff() > kJumpRad) {
    return "singularity";
  }
  joints_rad_ = near_rad;
  return {};
}

}  // namespace glint
