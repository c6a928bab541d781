// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/dashboard_replies.h"

#include <optional>

#include <fmt/format.h>

#include "hardware/robot/protocol/dashboard_text.h"
#include "hardware/twin/robot/twin_controller.h"

namespace glint {
namespace {

constexpr double kUnlockAfterS = 5.0;
constexpr double kPowerS = 1.0;
constexpr double kBrakeS = 0.5;

/// What a controller answers in every mode.
std::optional<std::string> reply_to_anyone(std::string_view line) {
  if (line == "close safety popup") {
    return "closing safety popup";
  }
  if (line == "popup" || line.starts_with("popup ")) {
    return "showing popup";
  }
  if (line == "close popup") {
    return "closing popup";
  }
  if (line.starts_with("addToLog ")) {
    return "Added log message";
  }
  if (line == "quit") {
    return "Disconnected";
  }
  return std::nullopt;
}

}  // namespace

std::string DashboardReplies::stop() {
  if (!twin_.program_ && !twin_.has_other_program_) {
    return "Failed to execute: stop";
  }
  twin_.program_.reset();
  twin_.has_other_program_ = false;
  constexpr double kStopRadS2 = 4.0;
  twin_.motion_.start_stop(kStopRadS2);
  return "Stopped";
}

std::string DashboardReplies::reply(std::string_view line) {
  if (is_query(line)) {
    return query(line);
  }
  const bool is_local = !twin_.is_remote_ && !is_cb3(twin_.settings_.arm.model());
  if (const auto text = reply_to_anyone(line)) {
    return *text;
  }
  if (is_local) {
    return fmt::format("Failed to execute: {}: not in remote control", line.substr(0, 80));
  }
  if (line == "unlock protective stop") {
    return unlock();
  }
  if (line == "power on" || line == "power off") {
    return power(line == "power on");
  }
  if (line == "brake release") {
    return release_brakes();
  }
  if (line == "restart safety") {
    return "Restarting safety";
  }
  if (line == "stop") {
    return stop();
  }
  if (line == "play" || line == "pause" || line == "shutdown") {
    return fmt::format("Failed to execute: {}", line);
  }
  if (line.starts_with("load ")) {
    return fmt::format("File not found: {}", line.substr(5, 80));
  }
  return fmt::format("could not understand: \"{}\"", line.substr(0, 80));
}

std::string DashboardReplies::query(std::string_view line) const {
  const bool is_cb3_arm = is_cb3(twin_.settings_.arm.model());
  const bool is_running = twin_.program_ || twin_.has_other_program_;
  if (line == "robotmode") {
    return fmt::format("Robotmode: {}", name_of(twin_.robot_mode_));
  }
  if (line == "safetymode") {
    return fmt::format("Safetymode: {}", name_of(twin_.safety_mode_));
  }
  if (line == "safetystatus") {
    return fmt::format("Safetystatus: {}", name_of(twin_.safety_mode_));
  }
  if (line == "running") {
    return fmt::format("Program running: {}", is_running);
  }
  if (line == "programState") {
    return fmt::format(
        "{} {}",
        name_of(twin_.runtime_state()),
        twin_.program_ && !twin_.program_->name.empty() ? twin_.program_->name : "<unnamed>");
  }
  if (line == "get loaded program") {
    return "No program loaded";
  }
  if (line == "PolyscopeVersion") {
    return fmt::format("URSoftware {}", twin_.version().text());
  }
  if (line == "get robot model") {
    return twin_.settings_.arm.model() == ArmModel::kUr5e ? "UR5" : "UR3";
  }
  if (line == "get serial number") {
    return twin_.settings_.serial_number;
  }
  return is_cb3_arm ? fmt::format("could not understand: \"{}\"", line)
                    : fmt::format("{}", twin_.is_remote_);
}

std::string DashboardReplies::unlock() {
  if (twin_.safety_mode_ != SafetyMode::kProtectiveStop) {
    return "Failed to execute: unlock protective stop: there is none";
  }
  if (twin_.time_s_ - twin_.stopped_at_s_ < kUnlockAfterS) {
    return "Cannot unlock protective stop until 5s after occurrence. Always inspect cause of "
           "protective stop before unlocking";
  }
  twin_.safety_mode_ = SafetyMode::kNormal;
  return "Protective stop releasing";
}

std::string DashboardReplies::power(bool is_on) {
  if (is_on && !allows_motion(twin_.safety_mode_)) {
    return "Failed to execute: power on: the robot is stopped by safety";
  }
  if (is_on && twin_.robot_mode_ != RobotMode::kPowerOff) {
    return "Powering on";
  }
  twin_.powering_to_ = is_on ? RobotMode::kIdle : RobotMode::kPowerOff;
  twin_.powering_s_ = kPowerS;
  return is_on ? "Powering on" : "Powering off";
}

std::string DashboardReplies::release_brakes() {
  if (twin_.robot_mode_ == RobotMode::kRunning) {
    return "Brake releasing";
  }
  if (twin_.robot_mode_ != RobotMode::kIdle || !allows_motion(twin_.safety_mode_)) {
    return "Failed to execute: brake release";
  }
  twin_.powering_to_ = RobotMode::kRunning;
  twin_.powering_s_ = kBrakeS;
  return "Brake releasing";
}

}  // namespace glint
