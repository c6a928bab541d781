// SPDX-License-Identifier: GPL-3.0-or-later
//
// Motions of the twin's arm in time: trapezoids of speed along joints or along a line, and stops.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "hardware/robot/path_check.h"
#include "hardware/robot/trapezoid.h"

namespace glint {

/// A movej: all joints in the leading joint's time.
struct JointMotion {
  JointVector from_rad;
  JointVector way_rad;
  Trapezoid leading;
};

/// A movel.
struct LineMotion {
  Eigen::Isometry3d from;  ///< base_from_tcp
  Eigen::Isometry3d to;
  double length_mm;
  Trapezoid along;
  std::optional<JointVector> goal_rad;  ///< none: the arm does not get there
};

/// Joints that slow down together, each with the same share of its speed.
struct StopMotion {
  JointVector from_rad;
  JointVector speed_rad_s;
  double duration_s;
};

/// Where the arm is, and what it is doing.
class ArmMotion {
 public:
  /// @param arm  outlives the motion
  ArmMotion(const Arm& arm, const JointVector& joints_rad);

  const JointVector& joints_rad() const { return joints_rad_; }

  const JointVector& speed_rad_s() const { return speed_rad_s_; }

  bool is_moving() const { return !std::holds_alternative<std::monostate>(motion_); }

  /// Where the motion leads; the arm's joints when there is none; none: a
  /// line that ends on its way, or a stop.
  std::optional<JointVector> goal_rad() const;

  /// How much of the motion's time has passed, 0 to 1; 1 when there is none.
  double progress() const;

  void start_joints(const JointVector& goal_rad, double speed, double acceleration);
  void start_line(const Eigen::Isometry3d& flange_from_tcp,
                  const Eigen::Isometry3d& base_from_tcp,
                  double speed_mm_s,
                  double acceleration_mm_s2);
  void start_stop(double deceleration_rad_s2);

  /// Ends any motion at once: the arm stands where it is.
  void stand();

  /// @return what ends the motion before its goal: "joint limit", "singularity"; empty: nothing
  std::string advance(double dt_s);

 private:
  std::string advance_line(const LineMotion& line);
  /// Of a moving arm at its time: not the mean of the last step, with which an arm that stops while
  /// it slows down would go beyond its goal.
  JointVector speed_after(const JointVector& before_rad, double before_s) const;
  std::optional<JointVector> end_of_line() const;

  const Arm* arm_;
  Eigen::Isometry3d flange_from_tcp_ = Eigen::Isometry3d::Identity();
  JointVector joints_rad_;
  JointVector speed_rad_s_ = JointVector::Zero();
  std::variant<std::monostate, JointMotion, LineMotion, StopMotion> motion_;
  double time_s_ = 0.0;
  double duration_s_ = 0.0;
};

}  // namespace glint
