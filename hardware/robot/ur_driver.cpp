// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/ur_driver.h"

#include <fmt/format.h>

namespace glint {
namespace {

constexpr double kStopTimeoutS = 3.0;
constexpr double kQuietS = 0.1;  ///< still for so long after a stop was sent: nothing begins yet

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

std::string UrDriver::take_script_output() {
  if (stopping_ && !stop_output_.empty()) {
    stopping_->is_taken = true;
  }
  is_sent_ = is_sent_ || !motion_output_.empty();
  return std::exchange(motion_output_, {}) + std::exchange(stop_output_, {});
}

void UrDriver::on_rtde(std::string_view bytes, double now_s) {
  told_s_ = now_s;
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
  if (tcp_difference(state, arm_, settings_).empty()) {
    still_.add(state);
  } else {
    still_ = StillPoseRule();  // the pose is of another point than the cell's TCP
  }
  if (const MotionOutcome stop = stop_of(state.safety_mode); stop != MotionOutcome::kDone) {
    halt({.outcome = stop, .text = fmt::format("safety mode {}", name_of(state.safety_mode))});
  }
  if (watch_) {
    watch_->on_package(state, now_s);
    has_begun_ = watch_->has_begun();
    look_at_motion(now_s);
  }
  look_at_stop(now_s);
}

// A motion that has not gone out yet never does: it would be made after the stop.
void UrDriver::halt(const MotionResult& result) {
  motion_output_.clear();
  if (!halted_) {
    halted_ = result;
  }
}

void UrDriver::look_at_motion(double now_s) {
  if (!watch_ || !watch_->result()) {
    return;
  }
  using enum MotionOutcome;
  const MotionResult result = *watch_->result();
  const bool must_stop = watch_->must_stop();
  const bool has_ended = result.outcome == kDone || result.outcome == kUnreachable;
  is_sent_ = is_sent_ && !has_ended && !watch_->is_other_program();
  watch_.reset();
  if (!has_ended) {
    halt(result);
  }
  if (must_stop) {
    send_stop(result, now_s);
  } else {
    result_ = result;
  }
}

void UrDriver::send_stop(const MotionResult& result, double now_s) {
  motion_output_.clear();
  stop_output_ = stop_script(arm_.limits.joint_acceleration_rad_s2);
  stopping_ = Stopping{.by_s = now_s + kStopTimeoutS, .result = result, .quiet_from_s = {}};
}

/// Of a stop that was sent, after which nobody tells whether the arm stands.
MotionResult UrDriver::blind_result(const MotionResult& result) const {
  if (result.outcome == MotionOutcome::kDone) {
    return *lost_;
  }
  const bool is_told = result.text == lost_->text;
  return {.outcome = result.outcome,
          .text = fmt::format("{}; whether the arm stands is not known{}",
                              result.text,
                              is_told ? "" : ": " + lost_->text)};
}

void UrDriver::look_at_stop(double now_s) {
  if (!stopping_ || !stopping_->is_taken) {
    return;
  }
  if (is_blind_) {
    result_ = blind_result(stopping_->result);
  } else if (state_->is_program_running() || !state_->is_still()) {
    stopping_->quiet_from_s.reset();
  } else {
    stopping_->quiet_from_s = stopping_->quiet_from_s.value_or(now_s);
    if (now_s - *stopping_->quiet_from_s >= kQuietS) {
      result_ = stopping_->result;
    }
  }
  if (result_) {
    stopping_.reset();
  }
}

void UrDriver::lose(const std::string& why) {
  const MotionResult lost = {.outcome = MotionOutcome::kLost, .text = why};
  lost_ = lost_.value_or(lost);
  halt(lost);
  still_ = StillPoseRule();
  if (watch_) {
    watch_->on_lost(why);
    look_at_motion(told_s_);
  }
}

void UrDriver::on_rtde_closed(const std::string& why) {
  is_blind_ = true;
  lose(why);
}

void UrDriver::on_primary(std::string_view bytes) {
  try {
    primary_.append(bytes);
    while (const auto frame = primary_.next()) {
      const auto message = parse_primary(frame->kind, frame->payload);
      if (message && watch_) {
        watch_->on_message(*message);
      }
    }
  } catch (const ProtocolError& error) {
    lose(error.what());
    throw;
  }
}

void UrDriver::on_primary_closed(const std::string& why) {
  if (stopping_) {
    send_stop(stopping_->result, told_s_);
  }
  lose(why);
}

void UrDriver::on_time(double now_s) {
  told_s_ = now_s;
  if (state_ && now_s - new_at_s_ > stall_s(rtde_.rate_hz())) {
    is_blind_ = true;
    lose(fmt::format("no new package for {:.2f} s", now_s - new_at_s_));
  }
  if (watch_) {
    watch_->on_time(now_s);
    look_at_motion(now_s);
  }
  if (is_blind_) {
    look_at_stop(now_s);
  }
  if (stopping_ && now_s > stopping_->by_s) {
    const bool is_stop_alone = stopping_->result.is_done();
    result_ = is_stop_alone ? MotionResult{.outcome = MotionOutcome::kTimeout, .text = ""}
                            : stopping_->result;
    result_->text += is_stop_alone ? "the arm did not stop" : "; the arm did not stop";
    stopping_.reset();
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

std::optional<MotionResult> UrDriver::refusal(double now_s) const {
  if (!may_move_) {
    return refused("motion was not allowed with --move");
  }
  if (halted_) {
    return halted_;
  }
  if (!state_ || now_s - new_at_s_ > stall_s(rtde_.rate_hz())) {
    return refused("the robot's pose is unknown");
  }
  if (watch_ || stopping_) {
    return refused("a motion is going on");
  }
  if (std::string text = motion_refusal(*state_, arm_, settings_); !text.empty()) {
    return refused(std::move(text));
  }
  return std::nullopt;
}

std::optional<MotionResult> UrDriver::begin(const CheckedMotion& motion, double now_s) {
  if (auto why = refusal(now_s)) {
    return why;
  }
  if (!motion.is_allowed()) {
    return MotionResult{.outcome = MotionOutcome::kUnreachable, .text = motion.text};
  }
  constexpr double kStartRad = 1e-3;
  if (!((motion.start_rad - state_->actual_q_rad).array().abs() <= kStartRad).all()) {
    return refused("the arm is not where the motion was planned from");
  }
  const ScriptAck ack = ScriptAck::after(state_->ack);
  motion_output_ = motion_script(motion, settings_.ack_register, ack);
  result_.reset();
  is_sent_ = false;
  has_begun_ = false;
  still_ = StillPoseRule();
  watch_.emplace(
      motion, ack, arm_, settings_, state_->speed_scaling * state_->slider.value_or(1.0), now_s);
  return std::nullopt;
}

std::optional<MotionResult> UrDriver::begin_stop(double now_s) {
  if (!may_move_) {
    return refused("stopping sends a script, which was not allowed with --move");
  }
  if (lost_) {
    return lost_;  // nobody would tell that the arm has stopped
  }
  result_.reset();
  watch_.reset();
  send_stop({.outcome = MotionOutcome::kDone, .text = ""}, now_s);
  return std::nullopt;
}

void UrDriver::interrupt(double now_s) {
  if (watch_) {
    watch_->on_interrupt();
    look_at_motion(now_s);
  }
}

/// What a controller that is stopped by safety says of its program is not relied on.
bool UrDriver::may_hold_program() const {
  const bool is_gone = has_begun_ && !lost_ && state_ && allows_motion(state_->safety_mode) &&
                       !state_->is_program_running();
  return is_sent_ && halted_ && !is_gone;
}

void UrDriver::on_program_dropped(const std::string& why) {
  is_sent_ = false;
  if (!why.empty() && result_) {
    result_->text += fmt::format(
        "; the controller may still have the program of the motion and go on with it: end it at "
        "the "
        "pendant ({})",
        why);
    halted_ = result_;
  }
}

void UrDriver::explain_timeout(const std::string& why) {
  if (result_ && result_->outcome == MotionOutcome::kTimeout) {
    result_ = MotionResult{.outcome = MotionOutcome::kProgramStopped,
                           .text = fmt::format("{} ({})", why, result_->text)};
    halted_ = result_;
  }
}

}  // namespace glint
