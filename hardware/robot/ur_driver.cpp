// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/ur_driver.h"

#include <fmt/format.h>

namespace glint {
namespace {

constexpr double kStopTimeoutS = 3.0;

MotionResult refused(std::string text) {
  return {.outcome = MotionOutcome::kRefused, .text = std::move(text)};
}

}  // namespace

UrDriver::UrDriver(UrSettings settings, ArmWithTool arm)
    : settings_(std::move(settings)),
      arm_(std::move(arm)),
      rtde_({.outputs = state_outputs(settings_.ack_register),
             .newer = newer_outputs(),
             .inputs = {},
             .rate_hz = 0.0}) {}

void UrDriver::on_rtde(std::string_view bytes, double now_s) {
  try {
    rtde_.feed(bytes, [this, now_s] { on_package(now_s); });
  } catch (const ProtocolError& error) {
    lose(error.what());
    throw;
  }
}

void UrDriver::on_package(double now_s) {
  const RobotState state = state_of(rtde_, settings_.ack_register);
  if (state_ && state.timestamp_s < state_->timestamp_s) {
    lose("the controller has restarted");
    return;
  }
  const bool is_new = !state_ || state.timestamp_s > state_->timestamp_s;
  if (!is_new) {
    return;  // an old package tells nothing of now
  }
  state_ = state;
  new_at_s_ = now_s;
  still_.add(state);
  if (const MotionOutcome stop = stop_of(state.safety_mode); stop != MotionOutcome::kDone) {
    halt({.outcome = stop, .text = fmt::format("safety mode {}", name_of(state.safety_mode))});
  }
  if (watch_) {
    watch_->on_package(state, now_s);
    look_at_motion();
  }
  if (stop_by_s_ && !state.is_program_running() && state.is_still()) {
    stop_by_s_.reset();
    result_ = result_ ? result_ : MotionResult{.outcome = MotionOutcome::kDone, .text = ""};
  }
}

void UrDriver::halt(const MotionResult& result) {
  if (!halted_) {
    halted_ = result;
  }
}

void UrDriver::look_at_motion() {
  if (!watch_ || !watch_->result()) {
    return;
  }
  using enum MotionOutcome;
  result_ = watch_->result();
  if (watch_->must_stop()) {
    script_output_ += stop_script(arm_.limits.joint_acceleration_rad_s2);
  }
  if (result_->outcome != kDone && result_->outcome != kUnreachable) {
    halt(*result_);
  }
  watch_.reset();
}

void UrDriver::lose(const std::string& why) {
  if (watch_) {
    watch_->on_lost(why);
    look_at_motion();
  }
  const MotionResult lost = {.outcome = MotionOutcome::kLost, .text = why};
  if (stop_by_s_) {
    stop_by_s_.reset();
    result_ = result_ ? result_ : lost;
  }
  still_ = StillPoseRule();
  halt(lost);
}

void UrDriver::on_rtde_closed(const std::string& why) {
  lose(why);
}

void UrDriver::on_primary(std::string_view bytes) {
  try {
    primary_.append(bytes);
    while (const auto frame = primary_.next()) {
      const auto message = parse_primary(frame->kind, frame->payload);
      if (message && watch_) {
        watch_->on_message(*message);
        look_at_motion();
      }
    }
  } catch (const ProtocolError& error) {
    lose(error.what());
    throw;
  }
}

void UrDriver::on_primary_closed(const std::string& why) {
  lose(why);
}

void UrDriver::on_time(double now_s) {
  if (state_ && now_s - new_at_s_ > stall_s(rtde_.rate_hz())) {
    lose(fmt::format("no new package for {:.2f} s", now_s - new_at_s_));
  }
  if (watch_) {
    watch_->on_time(now_s);
    look_at_motion();
  }
  if (stop_by_s_ && now_s > *stop_by_s_) {
    stop_by_s_.reset();
    result_ = MotionResult{.outcome = MotionOutcome::kTimeout, .text = "the arm did not stop"};
    halt(*result_);
  }
}

std::optional<RobotState> UrDriver::state(double now_s) const {
  std::optional<RobotState> state = state_;
  if (state) {
    state->age_s = now_s - new_at_s_;
  }
  return state;
}

std::optional<MotionResult> UrDriver::begin(const CheckedMotion& motion, double now_s) {
  if (!may_move_) {
    return refused("motion was not allowed with --move");
  }
  if (halted_) {
    return halted_;
  }
  if (!state_ || now_s - new_at_s_ > stall_s(rtde_.rate_hz())) {
    return refused("the robot's pose is unknown");
  }
  if (watch_ || stop_by_s_) {
    return refused("a motion is going on");
  }
  if (std::string text = motion_refusal(*state_, arm_, settings_); !text.empty()) {
    return refused(std::move(text));
  }
  if (!motion.is_allowed()) {
    return MotionResult{.outcome = MotionOutcome::kUnreachable, .text = motion.text};
  }
  constexpr double kStartRad = 1e-3;
  if ((motion.start_rad - state_->actual_q_rad).cwiseAbs().maxCoeff() > kStartRad) {
    return refused("the arm is not where the motion was planned from");
  }
  const ScriptAck ack = ScriptAck::after(state_->ack);
  script_output_ += motion_script(motion, settings_.ack_register, ack);
  result_.reset();
  still_ = StillPoseRule();
  watch_.emplace(motion, ack, arm_, settings_, state_->speed_scaling, now_s);
  return std::nullopt;
}

std::optional<MotionResult> UrDriver::begin_stop(double now_s) {
  if (!may_move_) {
    return refused("stopping sends a script, which was not allowed with --move");
  }
  if (halted_ && halted_->outcome == MotionOutcome::kLost) {
    return halted_;  // nobody would tell that the arm has stopped
  }
  script_output_ += stop_script(arm_.limits.joint_acceleration_rad_s2);
  result_.reset();
  watch_.reset();
  stop_by_s_ = now_s + kStopTimeoutS;
  return std::nullopt;
}

}  // namespace glint
