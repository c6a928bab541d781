// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/protocol/robot_modes.h"

#include <array>

namespace glint {
namespace {

constexpr std::array<std::string_view, 10> kRobotModes = {"NO_CONTROLLER",
                                                          "DISCONNECTED",
                                                          "CONFIRM_SAFETY",
                                                          "BOOTING",
                                                          "POWER_OFF",
                                                          "POWER_ON",
                                                          "IDLE",
                                                          "BACKDRIVE",
                                                          "RUNNING",
                                                          "UPDATING_FIRMWARE"};
constexpr std::array<std::string_view, 11> kSafetyModes = {"NORMAL",
                                                           "REDUCED",
                                                           "PROTECTIVE_STOP",
                                                           "RECOVERY",
                                                           "SAFEGUARD_STOP",
                                                           "SYSTEM_EMERGENCY_STOP",
                                                           "ROBOT_EMERGENCY_STOP",
                                                           "VIOLATION",
                                                           "FAULT",
                                                           "VALIDATE_JOINT_ID",
                                                           "UNDEFINED_SAFETY_MODE"};
constexpr std::array<std::string_view, 6> kRuntimeStates = {
    "STOPPING", "STOPPED", "PLAYING", "PAUSING", "PAUSED", "RESUMING"};

template <std::size_t Size>
std::string_view name_at(const std::array<std::string_view, Size>& names, std::int64_t i) {
  return i >= 0 && i < static_cast<std::int64_t>(Size) ? names[static_cast<std::size_t>(i)]
                                                       : "UNKNOWN";
}

}  // namespace

std::string_view name_of(RobotMode mode) {
  return name_at(kRobotModes, static_cast<std::int64_t>(mode) + 1);
}

std::string_view name_of(SafetyMode mode) {
  return name_at(kSafetyModes, static_cast<std::int64_t>(mode) - 1);
}

std::string_view name_of(RuntimeState state) {
  return name_at(kRuntimeStates, static_cast<std::int64_t>(state));
}

std::uint32_t safety_status_bits(SafetyMode mode) {
  constexpr std::uint32_t kEmergency = 1U << 7;
  constexpr std::uint32_t kStopped = 1U << 10;
  const auto number = static_cast<std::uint32_t>(mode);
  std::uint32_t bits = number >= 1 && number <= 7 ? 1U << (number - 1) : 0U;
  bits |= mode == SafetyMode::kViolation ? 1U << 8 : 0U;
  bits |= mode == SafetyMode::kFault ? 1U << 9 : 0U;
  bits |= is_emergency_stop(mode) ? kEmergency : 0U;
  return bits | (allows_motion(mode) || mode == SafetyMode::kRecovery ? 0U : kStopped);
}

bool allows_motion(SafetyMode mode) {
  return mode == SafetyMode::kNormal || mode == SafetyMode::kReduced;
}

bool is_emergency_stop(SafetyMode mode) {
  return mode == SafetyMode::kSystemEmergencyStop || mode == SafetyMode::kRobotEmergencyStop;
}

}  // namespace glint
