// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/motion_watch.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr double kBeginTimeoutS = 2.0;
constexpr double kReasonS =
    0.1;  ///< how long the controller's reason may come after the stop itself
constexpr double kArrivedRad = 2e-3;
constexpr double kArrivedMm = 1.0;  ///< of the TCP, at the end of a line
constexpr double kArrivedTurnRad = 5e-3;
constexpr double kSlowestScaling = 0.05;
constexpr double kOffWayRad = 0.03;  ///< controllers cut no corners: a joint lags along the way
constexpr double kOffWayMm = 10.0;
constexpr double kBeatS = 0.25;  ///< a program of Glint's changes its register more often
constexpr double kFirstS = 0.4;  ///< and writes it first within this time
/// The register changes every 20 ms: of packages that are further apart each may hold the same.
constexpr double kMaxPeriodS = 0.019;

/// How fast a motion is waited for, of its own speed. What is no number is the slowest.
double awaited_pace(double speed_scaling) {
  return speed_scaling >= kSlowestScaling ? std::min(speed_scaling, 1.0) : kSlowestScaling;
}

/// Why an arm has not arrived in time, as far as a state tells it.
std::string late_text(const RobotState& state) {
  std::string text = "the arm did not arrive in time";
  if (state.runtime_state != RuntimeState::kPlaying) {
    text += fmt::format("; program {}", name_of(state.runtime_state));
  }
  const double pace = state.speed_scaling * state.slider.value_or(1.0);
  if (!(pace >= kSlowestScaling)) {
    text += fmt::format("; it goes at {:.0f} % of its speed", 100.0 * pace);
  }
  return text;
}

/// How far a point is from the segment between two others: its largest component.
double off_segment(const auto& from, const auto& to, const auto& at) {
  const auto way = (to - from).eval();
  const double length_sq = way.squaredNorm();
  const double share =
      length_sq > 0.0 ? std::clamp((at - from).dot(way) / length_sq, 0.0, 1.0) : 0.0;
  return (at - from - share * way).cwiseAbs().maxCoeff();
}

/// Words by which controllers name poses that they find no joints for.
constexpr std::array<std::string_view, 5> kKinematicWords = {
    "inverse kin", "singular", "joint limit", "unreachable", "reach"};

bool is_kinematic(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  return std::ranges::any_of(kKinematicWords, [&lower](std::string_view word) {
    return lower.find(word) != std::string::npos;
  });
}

}  // namespace

double stall_s(double rate_hz) {
  return std::max(5.0 / rate_hz, 0.2);
}

MotionOutcome stop_of(SafetyMode mode) {
  if (allows_motion(mode)) {
    return MotionOutcome::kDone;
  }
  if (is_emergency_stop(mode)) {
    return MotionOutcome::kEmergencyStop;
  }
  return mode == SafetyMode::kSafeguardStop ? MotionOutcome::kSafeguardStop
                                            : MotionOutcome::kProtectiveStop;
}

MotionWatch::MotionWatch(const CheckedMotion& motion,
                         const ScriptAck& ack,
                         const ArmWithTool& arm,
                         const UrSettings& settings,
                         double speed_scaling,
                         double now_s)
    : motion_(motion),
      ack_(ack),
      arm_(arm),
      settings_(settings),
      begin_by_s_(now_s + kBeginTimeoutS),
      longest_s_(kBeginTimeoutS + 1.0 + 1.5 * motion.duration_s / awaited_pace(speed_scaling)) {}

void MotionWatch::end(MotionOutcome outcome, std::string text, bool must_stop) {
  if (!result_) {
    result_ = MotionResult{.outcome = outcome, .text = std::move(text)};
    must_stop_ = must_stop;
  }
}

void MotionWatch::on_package(const RobotState& state, double now_s) {
  end_by_stamp_ = end_by_stamp_.value_or(state.timestamp_s + longest_s_);
  start_mm_ = start_mm_.value_or(state.base_from_tcp.translation());
  is_program_running_ = state.is_program_running();
  if (const MotionOutcome stop = stop_of(state.safety_mode); stop != MotionOutcome::kDone) {
    end(stop, fmt::format("safety mode {}", name_of(state.safety_mode)), false);
  } else if (state.robot_mode != RobotMode::kRunning) {
    end(MotionOutcome::kProgramStopped,
        fmt::format("robot mode {}", name_of(state.robot_mode)),
        false);
  } else if (state.is_guided()) {
    end(MotionOutcome::kProgramStopped, "the teach button was pressed", true);
  } else if (!state.is_pose_known()) {
    end(MotionOutcome::kLost, "the robot's pose is unknown", true);
  } else if (is_within_limits(state) && is_on_its_way(state)) {
    look_for_other_program(state);
    look_at_program(state, now_s);
  }
  if (state.timestamp_s > *end_by_stamp_) {
    end(MotionOutcome::kTimeout, late_text(state), true);
  }
}

bool MotionWatch::is_within_limits(const RobotState& state) {
  if (!(state.tool_speed_mm_s <= arm_.limits.tool_speed_mm_s)) {
    end(MotionOutcome::kLimit,
        fmt::format("the tool moved at {:.1f} mm/s, limits.tool_speed_mm_s is {:.1f}",
                    state.tool_speed_mm_s,
                    arm_.limits.tool_speed_mm_s),
        true);
  } else if (std::string text = outside_box(arm_, state.actual_q_rad, 0.0); !text.empty()) {
    end(MotionOutcome::kLimit, std::move(text), true);
  } else if (std::string other = tcp_difference(state, arm_, settings_); !other.empty()) {
    end(MotionOutcome::kLimit, std::move(other), true);
  }
  return !result_;
}

/// A line's goal is a pose: whose joints a controller finds by its own calibration.
bool MotionWatch::has_arrived(const RobotState& state) const {
  if (motion_.kind == CheckedMotion::Kind::kJoints) {
    return (state.actual_q_rad - motion_.goal_rad).cwiseAbs().maxCoeff() < kArrivedRad;
  }
  const JointVector left = pose_difference(state.base_from_tcp, motion_.base_from_tcp);
  return left.head<3>().norm() < kArrivedMm && left.tail<3>().norm() < kArrivedTurnRad;
}

// Whatever moves the arm elsewhere is stopped: the way was checked, other ways were not.
bool MotionWatch::is_on_its_way(const RobotState& state) {
  has_begun_ = has_begun_ || ack_.is_of_program(state.ack);
  const bool is_joints = motion_.kind == CheckedMotion::Kind::kJoints;
  const double off_rad = off_segment(motion_.start_rad, motion_.goal_rad, state.actual_q_rad);
  const double off_mm = off_segment(
      *start_mm_, motion_.base_from_tcp.translation(), state.base_from_tcp.translation());
  if (has_begun_ && (is_joints ? off_rad > kOffWayRad : off_mm > kOffWayMm)) {
    end(MotionOutcome::kProgramStopped,
        "the arm has left its way: another program runs on the controller",
        true);
  }
  return !result_;
}

void MotionWatch::end_by_other_program() {
  if (!result_) {
    is_other_program_ = true;
    end(MotionOutcome::kProgramStopped, "another program runs on the controller", false);
  }
}

/// A program that took the place of ours is left alone. It does not change our register, or writes
/// what we do not.
void MotionWatch::look_for_other_program(const RobotState& state) {
  const bool is_close = state.timestamp_s - newest_stamp_s_ <= kMaxPeriodS;
  const bool is_playing = state.runtime_state == RuntimeState::kPlaying;
  if (!is_playing || !is_close || state.ack != newest_ack_) {
    same_from_s_.reset();
  }
  newest_ack_ = state.ack;
  newest_stamp_s_ = state.timestamp_s;
  if (has_begun_ && !ack_.is_of_program(state.ack)) {
    end_by_other_program();
  }
  if (!is_playing) {
    return;
  }
  same_from_s_ = same_from_s_.value_or(state.timestamp_s);
  if (state.timestamp_s - *same_from_s_ > (has_begun_ ? kBeatS : kFirstS)) {
    end_by_other_program();
  }
}

void MotionWatch::look_at_program(const RobotState& state, double now_s) {
  if (is_program_running_ || !state.is_still()) {
    stopped_at_s_.reset();
    return;
  }
  stopped_at_s_ = stopped_at_s_.value_or(now_s);
  if (!has_begun_) {
    look_at_refusal(now_s);
  } else if (state.ack == ack_.ended && has_arrived(state)) {
    end(MotionOutcome::kDone, "", false);
  } else if (now_s - *stopped_at_s_ > kReasonS) {
    end(is_kinematic_ ? MotionOutcome::kUnreachable : MotionOutcome::kProgramStopped,
        message_.empty() ? "the program ended before the arm had arrived" : message_,
        false);
  }
}

/// An exception may be another program's: what may begin yet is stopped.
void MotionWatch::look_at_refusal(double now_s) {
  if (is_refused_ && now_s - *stopped_at_s_ > kReasonS) {
    end(is_kinematic_ ? MotionOutcome::kUnreachable : MotionOutcome::kProgramStopped,
        message_,
        true);
  }
}

void MotionWatch::on_message(const PrimaryMessage& message) {
  if (message.kind == PrimaryMessage::Kind::kText) {
    return;
  }
  message_ = message.text;
  is_kinematic_ = is_kinematic(message.text);
  if (!has_begun_ && message.kind == PrimaryMessage::Kind::kRuntimeException) {
    is_refused_ = true;
    stopped_at_s_.reset();
  }
}

void MotionWatch::on_interrupt() {
  end(MotionOutcome::kProgramStopped, "interrupted", true);
}

void MotionWatch::on_lost(const std::string& why) {
  end(MotionOutcome::kLost, why, true);
}

// When the arm should have arrived is told by the controller's own clock, in on_package(): it is
// that clock by which it moves. A clock that stands still is a lost link.
void MotionWatch::on_time(double now_s) {
  if (has_begun_ || !(now_s > begin_by_s_)) {
    return;
  }
  if (is_program_running_) {
    end_by_other_program();
  } else {
    end(MotionOutcome::kTimeout, "the controller did not begin the motion", true);
  }
}

}  // namespace glint
