// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/twin_controller.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hardware/twin/robot/dashboard_replies.h"

namespace glint {
namespace {

constexpr double kSafetyStopRadS2 = 20.0;  ///< of stops by safety
constexpr std::size_t kMaxMessages = 100;

constexpr double kMmPerM = 1000.0;

Eigen::Isometry3d pose_of(const ScriptArgument& argument) {
  std::vector<double> six = argument.numbers;
  for (std::size_t i = 0; i < 3; ++i) {
    six[i] *= kMmPerM;
  }
  return pose_of_six(six);
}

bool is_motion(const ScriptStatement& statement) {
  return statement.function == "movej" || statement.function == "movel" ||
         statement.function == "stopj" || statement.function == "stopl";
}

}  // namespace

TwinController::TwinController(const TwinSettings& settings)
    : settings_(settings), motion_(settings_.arm, settings.start_rad) {}

ControllerVersion TwinController::version() const {
  return is_cb3(settings_.arm.model())
             ? ControllerVersion{.major = 3, .minor = 15, .bugfix = 8, .build = 106339}
             : ControllerVersion{.major = 5, .minor = 11, .bugfix = 4, .build = 108320};
}

Eigen::Isometry3d TwinController::tcp() const {
  Eigen::Isometry3d tcp = settings_.flange_from_tcp;
  tcp.translation().z() += has_wrong_tcp_ ? 10.0 : 0.0;
  return tcp;
}

RuntimeState TwinController::runtime_state() const {
  if (program_ && safety_mode_ == SafetyMode::kSafeguardStop) {
    return RuntimeState::kPaused;
  }
  return program_ || has_other_program_ ? RuntimeState::kPlaying : RuntimeState::kStopped;
}

void TwinController::set_inputs(const std::vector<std::string>& names,
                                const std::vector<RtdeValue>& values) {
  std::uint8_t mask = 0;
  std::uint8_t bits = 0;
  inputs_written_.insert(names.begin(), names.end());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string& name = names[i];
    if (name == "standard_digital_output_mask") {
      mask = std::get<std::uint8_t>(values[i]);
    } else if (name == "standard_digital_output") {
      bits = std::get<std::uint8_t>(values[i]);
    } else if (name.starts_with("input_int_register_")) {
      int_inputs_.at(register_number(name)) = std::get<std::int32_t>(values[i]);
    } else if (name.starts_with("input_double_register_")) {
      double_inputs_.at(register_number(name)) = std::get<double>(values[i]);
    }
  }
  digital_outputs_ = (digital_outputs_ & ~std::uint64_t{mask}) | (bits & mask);
}

void TwinController::step(double dt_s) {
  constexpr double kHeldPace = 1e-3;
  dt_s *= is_held_ ? kHeldPace : 1.0;
  time_s_ += dt_s;
  controller_s_ += dt_s;
  const bool was_moving = motion_.is_moving();
  moving_s_ = was_moving ? moving_s_ + dt_s : 0.0;
  still_s_ = was_moving ? 0.0 : still_s_ + dt_s;
  has_moved_ = has_moved_ || was_moving;
  apply_due_faults(dt_s);
  advance_power(dt_s);
  const bool is_stop = !allows_motion(safety_mode_);
  const bool runs_programs = !is_stop && robot_mode_ == RobotMode::kRunning;
  if (!is_held_ || is_stop) {
    if (const std::string problem = motion_.advance(dt_s); !problem.empty()) {
      fail_program(problem);
    }
    if (runs_programs) {
      advance_program(dt_s);
    }
  }
  if (runs_programs) {
    advance_threads(dt_s);  // while a motion waits for its picture, too
  }
}

void TwinController::apply_due_faults(double dt_s) {
  std::vector<Fault> due;
  std::erase_if(faults_, [&](const Fault& fault) {
    const bool is_due =
        fault.when == Fault::When::kNow ||
        (fault.when == Fault::When::kMoving && motion_.is_moving() && moving_s_ >= fault.delay_s) ||
        (fault.when == Fault::When::kStill && has_moved_ && !motion_.is_moving() &&
         still_s_ >= fault.delay_s + dt_s);
    if (is_due) {
      due.push_back(fault);
    }
    return is_due;
  });
  for (const Fault& fault : due) {
    apply(fault.kind);
  }
}

void TwinController::apply(FaultKind kind) {
  ++num_faults_applied_;
  switch (kind) {
    case FaultKind::kProtectiveStop:
      stop_by_safety(SafetyMode::kProtectiveStop);
      break;
    case FaultKind::kEmergencyStop:
      stop_by_safety(SafetyMode::kRobotEmergencyStop);
      break;
    case FaultKind::kSafeguardStop:
      stop_by_safety(SafetyMode::kSafeguardStop);
      break;
    case FaultKind::kJointLimit:
      fail_program("joint limit: position of joint 3 is out of range");
      break;
    case FaultKind::kSingular:
      fail_program("movel: singularity, the path cannot be followed");
      break;
    case FaultKind::kUnreachable:
      fail_program("get_inverse_kin: no inverse kinematics found");
      break;
    case FaultKind::kOverspeed:
      is_overspeed_ = true;
      break;
    case FaultKind::kSilence:
      is_silent_ = true;
      break;
    case FaultKind::kOldStamps:
      has_old_stamps_ = true;
      break;
    case FaultKind::kWrongTcp:
      has_wrong_tcp_ = true;
      break;
    case FaultKind::kWrongPayload:
      has_wrong_payload_ = true;
      break;
    case FaultKind::kRemoteOff:
      is_remote_ = false;
      end_program();
      break;
    case FaultKind::kOtherProgram:
      end_program();
      has_other_program_ = true;
      break;
    case FaultKind::kCut:
    case FaultKind::kRestart:
    case FaultKind::kSplit:
      network_faults_.push_back(kind);
      break;
    case FaultKind::kRelease:
      release();
      break;
  }
}

void TwinController::end_program() {
  if (program_) {
    program_.reset();
    is_held_ = false;
    motion_.start_stop(kSafetyStopRadS2);
  }
}

void TwinController::release() {
  is_silent_ = false;
  has_old_stamps_ = false;
  has_wrong_tcp_ = false;
  has_wrong_payload_ = false;
  is_overspeed_ = false;
  is_remote_ = true;
  has_other_program_ = false;
  network_faults_.push_back(FaultKind::kRelease);
  if (safety_mode_ == SafetyMode::kSafeguardStop || is_emergency_stop(safety_mode_)) {
    safety_mode_ = SafetyMode::kNormal;  // after an emergency stop without power
  }
}

void TwinController::stop_by_safety(SafetyMode mode) {
  // A stop of a lesser kind does not take the place of a graver one.
  const bool is_safeguard = mode == SafetyMode::kSafeguardStop;
  if (is_emergency_stop(safety_mode_) ||
      (safety_mode_ == SafetyMode::kProtectiveStop && is_safeguard)) {
    return;
  }
  safety_mode_ = mode;
  stopped_at_s_ = time_s_;
  if (is_safeguard) {
    pause_program();
  } else {
    program_.reset();
  }
  is_held_ = false;
  motion_.start_stop(kSafetyStopRadS2);
  tell(PrimaryMessage::Kind::kErrorCode, std::string(name_of(mode)));
  if (is_emergency_stop(mode)) {
    constexpr double kPowerOffS = 0.5;
    powering_to_ = RobotMode::kPowerOff;
    powering_s_ = kPowerOffS;
  }
}

/// The motion that is broken off is made again, from where the arm stands then, when the stop is
/// reset: the program goes on by itself.
void TwinController::pause_program() {
  if (program_ && next_statement_ > 0 && motion_.is_moving()) {
    --next_statement_;
  }
}

void TwinController::advance_power(double dt_s) {
  if (powering_s_ <= 0.0) {
    return;
  }
  powering_s_ -= dt_s;
  if (powering_s_ <= 0.0) {
    robot_mode_ = powering_to_;
    if (robot_mode_ == RobotMode::kPowerOff) {
      program_.reset();
    }
  }
}

void TwinController::restart() {
  controller_s_ = 0.0;
  is_held_ = false;
  program_.reset();
  motion_.stand();
  int_registers_ = {};
  double_registers_ = {};
  messages_.clear();
}

void TwinController::tell(PrimaryMessage::Kind kind, const std::string& text) {
  if (messages_.size() < kMaxMessages) {
    messages_.push_back({.stamp_us = static_cast<std::uint64_t>(1e6 * controller_s_),
                         .kind = kind,
                         .code = 0,
                         .argument = 0,
                         .text = text});
  }
}

std::string TwinController::reply(std::string_view line) {
  return DashboardReplies(*this).reply(line);
}

TwinView TwinController::view() const {
  return {.time_s = time_s_,
          .joints_rad = motion_.joints_rad(),
          .is_still = !motion_.is_moving(),
          .goal_rad = motion_.goal_rad(),
          .digital_outputs = digital_outputs_,
          .is_held = is_held_ && motion_.is_moving()};
}

void TwinController::run(const ScriptReader::Result& script) {
  if (!script.error.empty()) {
    tell(PrimaryMessage::Kind::kRuntimeException, "compile error: " + script.error);
    return;
  }
  if (!is_remote_ && !is_cb3(settings_.arm.model())) {
    return;  // a controller in local mode closes its ears without a word
  }
  if (!allows_motion(safety_mode_) || robot_mode_ != RobotMode::kRunning || has_other_program_) {
    tell(PrimaryMessage::Kind::kRuntimeException, "the robot is not ready to run a program");
    return;
  }
  if (script.program->is_secondary) {
    for (const ScriptStatement& statement : script.program->statements) {
      if (!is_motion(statement) && statement.function != "sleep") {
        execute(statement);
      }
    }
    return;
  }
  is_held_ = false;
  if (motion_.is_moving()) {
    constexpr double kReplacedRadS2 = 4.0;
    motion_.start_stop(kReplacedRadS2);
  }
  program_ = script.program;
  threads_.clear();
  next_statement_ = 0;
  sleep_s_ = 0.0;
}

void TwinController::advance_program(double dt_s) {
  sleep_s_ = std::max(0.0, sleep_s_ - dt_s);
  while (program_ && !motion_.is_moving() && sleep_s_ == 0.0) {
    if (next_statement_ == program_->statements.size()) {
      program_.reset();
      return;
    }
    const ScriptStatement statement = program_->statements[next_statement_];
    ++next_statement_;
    if (!execute(statement)) {
      return;
    }
  }
}

void TwinController::advance_threads(double dt_s) {
  if (!program_) {
    threads_.clear();
  }
  for (const ScriptStatement& statement : threads_.advance(dt_s)) {
    if (program_ && !is_motion(statement)) {
      execute(statement);
    }
  }
}

bool TwinController::write_register(const ScriptStatement& statement) {
  const double number = statement.number("register_id", 0, -1.0);
  const double value = statement.number("value", 1, 0.0);
  if (!(number >= 0.0 && number < 48.0) || !(std::abs(value) < 2147483648.0)) {
    fail_program("write_output_integer_register: out of range");
    return false;
  }
  int_registers_.at(static_cast<std::size_t>(number)) = static_cast<std::int32_t>(value);
  return true;
}

bool TwinController::set_output(const ScriptStatement& statement) {
  const double number = statement.number("n", 0, -1.0);
  if (!(number >= 0.0 && number < 8.0)) {
    fail_program(statement.function + ": out of range");
    return false;
  }
  const std::uint64_t bit = std::uint64_t{1} << static_cast<unsigned>(number);
  digital_outputs_ =
      statement.number("b", 1, 0.0) != 0.0 ? digital_outputs_ | bit : digital_outputs_ & ~bit;
  return true;
}

bool TwinController::execute(const ScriptStatement& statement) {
  const std::string& name = statement.function;
  if (is_motion(statement)) {
    return execute_motion(statement);
  }
  if (name == "sleep") {
    constexpr double kLongestS = 3600.0;
    sleep_s_ = std::clamp(statement.number("t", 0, 0.0), 0.0, kLongestS);
  } else if (name == "set_tcp") {
    settings_.flange_from_tcp = pose_of(statement.arguments[0]);
  } else if (name == "set_payload") {
    settings_.payload_kg = statement.number("m", 0, 0.0);
    const ScriptArgument* cog = statement.find("cog", 1);
    if (cog != nullptr && cog->numbers.size() == 3) {
      settings_.payload_cog_mm =
          kMmPerM * Eigen::Vector3d(cog->numbers[0], cog->numbers[1], cog->numbers[2]);
    }
  } else if (name == "write_output_integer_register") {
    return write_register(statement);
  } else if (name == "set_digital_out" || name == "set_standard_digital_out") {
    return set_output(statement);
  } else if (name == "kill") {
    threads_.kill(statement);
  } else if (name == "run" && (!program_ || !threads_.start(*program_, statement))) {
    fail_program("run: no such thread");
    return false;
  }
  return true;
}

bool TwinController::execute_motion(const ScriptStatement& statement) {
  if (statement.function == "stopj" || statement.function == "stopl") {
    motion_.start_stop(statement.number("a", 0, 2.0));
    return true;
  }
  const ScriptArgument& target = statement.arguments[0];
  if (statement.function == "movel") {
    motion_.start_line(tcp(),
                       pose_of(target),
                       kMmPerM * statement.number("v", 2, 0.25),
                       kMmPerM * statement.number("a", 1, 1.2));
    is_held_ = settings_.holds_motions && motion_.goal_rad().has_value();
    return true;
  }
  JointVector goal_rad;
  if (target.kind == ScriptArgument::Kind::kPose) {
    const Eigen::Isometry3d flange = pose_of(target) * tcp().inverse();
    const auto nearest =
        nearest_solution(settings_.arm.inverse(flange), motion_.joints_rad(), kJointLimitRad);
    if (!nearest) {
      fail_program("get_inverse_kin: no inverse kinematics found");
      return false;
    }
    goal_rad = *nearest;
  } else {
    goal_rad = Eigen::Map<const JointVector>(target.numbers.data());
  }
  motion_.start_joints(goal_rad, statement.number("v", 2, 1.05), statement.number("a", 1, 1.4));
  is_held_ = settings_.holds_motions;
  return true;
}

void TwinController::fail_program(const std::string& why) {
  if (!program_) {
    return;
  }
  tell(PrimaryMessage::Kind::kRuntimeException, why);
  program_.reset();
  constexpr double kFailedRadS2 = 8.0;
  motion_.start_stop(kFailedRadS2);
}

}  // namespace glint
