// SPDX-License-Identifier: GPL-3.0-or-later
//
// One motion from the moment its script was sent until it is known how it ended: a state machine
// fed with packages, messages and the time, without a network.
#pragma once

#include <optional>

#include "hardware/robot/path_check.h"
#include "hardware/robot/protocol/primary_message.h"
#include "hardware/robot/robot.h"
#include "hardware/robot/ur_script.h"

namespace glint {

/// No new package for so long means that the link is lost: 5 periods, 0.2 s at least.
double stall_s(double rate_hz);

/// done for a state that may go on, else the stop that it names.
MotionOutcome stop_of(SafetyMode mode);

class MotionWatch {
 public:
  /// @param arm, settings  outlive the watch
  MotionWatch(const CheckedMotion& motion,
              const ScriptAck& ack,
              const ArmWithTool& arm,
              const UrSettings& settings,
              double speed_scaling,
              double now_s);

  void on_package(const RobotState& state, double now_s);
  void on_message(const PrimaryMessage& message);
  void on_lost(const std::string& why);
  void on_interrupt();
  void on_time(double now_s);

  const std::optional<MotionResult>& result() const { return result_; }

  /// The arm may still be moving, or begin to: a stop has to be sent.
  bool must_stop() const { return must_stop_; }

  /// The motion's program was seen to run.
  bool has_begun() const { return has_begun_; }

  /// Another program has taken the place of the motion's: nothing is sent into it.
  bool is_other_program() const { return is_other_program_; }

 private:
  void end(MotionOutcome outcome, std::string text, bool must_stop);
  bool is_within_limits(const RobotState& state);
  bool has_arrived(const RobotState& state) const;
  bool is_on_its_way(const RobotState& state);
  void look_for_other_program(const RobotState& state);
  void end_by_other_program();
  void look_at_program(const RobotState& state, double now_s);
  void look_at_refusal(double now_s);

  CheckedMotion motion_;
  ScriptAck ack_;
  const ArmWithTool& arm_;
  const UrSettings& settings_;
  double begin_by_s_;
  double longest_s_;                    ///< that the motion may take, by the controller's clock
  std::optional<double> end_by_stamp_;  ///< of that clock, once a package has told the time
  bool has_begun_ = false;
  bool is_other_program_ = false;
  bool is_program_running_ = false;     ///< by the newest package
  std::optional<double> stopped_at_s_;  ///< when the program was first seen not to run any more
  std::int32_t newest_ack_ = 0;
  double newest_stamp_s_ = 0.0;
  std::optional<double> same_from_s_;        ///< a program plays since then and changes no register
  std::optional<Eigen::Vector3d> start_mm_;  ///< of the TCP, as the controller told it first
  std::string message_;                      ///< the controller's reason
  bool is_refused_ = false;    ///< the reason came before the motion had begun, as an exception
  bool is_kinematic_ = false;  ///< the reason is that there are no joints for the pose
  std::optional<MotionResult> result_;
  bool must_stop_ = false;
};

}  // namespace glint
