// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "hardware/robot/robot_state.h"
#include "hardware/robot/still_pose.h"

namespace glint {

enum class MotionOutcome {
  kDone,
  kProtectiveStop,
  kSafeguardStop,
  kEmergencyStop,
  kUnreachable,  ///< no joints for the pose, or none that limits allow; the controller's word, too
  kLimit,        ///< a limit of the cell was passed in motion: the arm was stopped
  kProgramStopped,  ///< the program ended before its end, by the pendant or by an error
  kTimeout,         ///< not begun in time, or not ended
  kLost,            ///< no data, or none that are new
  kRefused          ///< nothing was sent
};

/// "done", "protective_stop", ...: as JSON has it.
std::string_view name_of(MotionOutcome outcome);

struct MotionResult {
  MotionOutcome outcome = MotionOutcome::kRefused;
  std::string text;  ///< for people; empty when done

  bool is_done() const { return outcome == MotionOutcome::kDone; }
};

/// A robot that is moved from one standstill to the next. After any outcome but done, unreachable
/// and refused nothing moves it any more: the stop is named again, and a person has to look.
class Robot {
 public:
  virtual ~Robot() = default;

  /// The newest snapshot; none: nothing has come yet.
  virtual std::optional<RobotState> state() const = 0;

  /// Both return when the arm stands still, or when it is known why it will not arrive.
  /// @param share  of the cell's limits of speed, in (0, 1]
  virtual MotionResult move_joints(const JointVector& goal_rad, double share) = 0;
  virtual MotionResult move_line(const Eigen::Isometry3d& base_from_tcp, double share) = 0;

  /// Stops the arm where it is.
  virtual MotionResult stop() = 0;

  /// Waits until the arm stands still by the rule of StillPoseRule, and tells where.
  /// @return none when it does not within the time, or stands with another TCP than the cell's
  virtual std::optional<StillPose> still_pose(double timeout_s) = 0;

  /// After this stop nothing moves any more, also when it has been reset; none: there was none.
  virtual std::optional<MotionResult> halted() const { return std::nullopt; }
};

}  // namespace glint
