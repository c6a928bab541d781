// SPDX-License-Identifier: GPL-3.0-or-later
//
// A UR robot without a network: bytes of RTDE and of the primary interface in, bytes out, and the
// time. UrRobot connects it with sockets, tests with a controller on an injected clock.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "hardware/robot/motion_permit.h"
#include "hardware/robot/motion_watch.h"
#include "hardware/robot/rtde_client.h"

namespace glint {

class UrDriver {
 public:
  UrDriver(UrSettings settings, ArmWithTool arm);
  UrDriver(const UrDriver&) = delete;
  UrDriver& operator=(const UrDriver&) = delete;

  /// Without it no byte for the primary interface is ever made.
  void allow_motion(const MotionPermit&) { may_move_ = true; }

  std::string take_rtde_output() { return rtde_.take_output(); }

  /// A motion is written out before the stop behind it. One that waits when the arm is stopped is
  /// dropped.
  std::string take_script_output();

  /// The arm is being stopped: what goes out ends in the stop.
  bool is_stopping() const { return stopping_.has_value(); }

  /// All times are seconds of one clock that never goes back.
  void on_rtde(std::string_view bytes, double now_s);
  void on_rtde_closed(const std::string& why);
  void on_primary(std::string_view bytes);

  /// A stop that may not have arrived is to be written once more.
  void on_primary_closed(const std::string& why);
  void on_time(double now_s);

  bool is_streaming() const { return state_.has_value(); }

  std::optional<RobotState> state(double now_s) const;

  const RtdeClient& rtde() const { return rtde_; }

  const UrSettings& settings() const { return settings_; }

  const ArmWithTool& arm() const { return arm_; }

  /// Begins a motion, or says at once why not.
  /// @return none: it goes on, until result() has one
  std::optional<MotionResult> begin(const CheckedMotion& motion, double now_s);
  std::optional<MotionResult> begin_stop(double now_s);

  /// Why no motion would be begun now, wherever it led; none: nothing speaks against one.
  std::optional<MotionResult> refusal(double now_s) const;

  /// Somebody wants the motion that goes on to end here.
  void interrupt(double now_s);

  /// A timeout whose reason was found out afterwards.
  void explain_timeout(const std::string& why);

  /// Of the motion or stop that was begun last; none: it goes on. An arm that has to be stopped
  /// has its result when it stands still, or when it is known that it does not; without packages
  /// that would tell, as soon as the stop was taken.
  const std::optional<MotionResult>& result() const { return result_; }

  /// After this stop nothing moves any more; none: there was none.
  const std::optional<MotionResult>& halted() const { return halted_; }

  /// After a stop: the controller may still have the motion's program, which goes on when a person
  /// resets the stop. It has to be told to drop it.
  bool may_hold_program() const;

  /// It was told so. @param why  it may still have the program; empty: it has it no more
  void on_program_dropped(const std::string& why);

  /// Where the arm stands still, with the cell's TCP on the pendant.
  std::optional<StillPose> still_pose() const { return still_.pose(); }

  /// Waits for packages of a standstill from now on.
  void restart_still_pose() { still_ = StillPoseRule(); }

 private:
  /// A stop that is waited for.
  struct Stopping {
    double by_s = 0.0;    ///< it must have worked
    MotionResult result;  ///< when it has
    bool is_taken = false;
    std::optional<double> quiet_from_s;  ///< the arm still, no program
  };

  void on_package(double now_s);
  void halt(const MotionResult& result);
  void look_at_motion(double now_s);
  void send_stop(const MotionResult& result, double now_s);
  void look_at_stop(double now_s);
  MotionResult blind_result(const MotionResult& result) const;
  void lose(const std::string& why);

  UrSettings settings_;
  ArmWithTool arm_;
  RtdeClient rtde_;
  FrameSplitter primary_ = FrameSplitter::of_primary();
  std::string motion_output_;
  std::string stop_output_;
  bool may_move_ = false;
  bool is_sent_ = false;    ///< the newest motion, whose program is not known to have gone
  bool has_begun_ = false;  ///< its program was seen to run
  std::optional<RobotState> state_;
  double new_at_s_ = 0.0;  ///< when the newest package came
  std::optional<MotionWatch> watch_;
  double told_s_ = 0.0;  ///< the newest time that was given
  std::optional<Stopping> stopping_;
  std::optional<MotionResult> result_;
  std::optional<MotionResult> halted_;
  std::optional<MotionResult> lost_;  ///< a connection is gone, or RTDE has fallen silent
  bool is_blind_ = false;             ///< no package would tell that the arm stands
  StillPoseRule still_;
};

}  // namespace glint
