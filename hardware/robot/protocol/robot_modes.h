// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a controller says of its state. Numbers as RTDE has them; names as the dashboard writes
// them.
#pragma once

#include <cstdint>
#include <string_view>

namespace glint {

enum class RobotMode : std::int32_t {
  kNoController = -1,
  kDisconnected = 0,
  kConfirmSafety = 1,
  kBooting = 2,
  kPowerOff = 3,
  kPowerOn = 4,
  kIdle = 5,
  kBackdrive = 6,
  kRunning = 7,
  kUpdatingFirmware = 8
};

enum class SafetyMode : std::int32_t {
  kNormal = 1,
  kReduced = 2,
  kProtectiveStop = 3,
  kRecovery = 4,
  kSafeguardStop = 5,
  kSystemEmergencyStop = 6,
  kRobotEmergencyStop = 7,
  kViolation = 8,
  kFault = 9,
  kValidateJointId = 10,
  kUndefined = 11
};

/// Of a program on the controller.
enum class RuntimeState : std::uint32_t {
  kStopping = 0,
  kStopped = 1,
  kPlaying = 2,
  kPausing = 3,
  kPaused = 4,
  kResuming = 5
};

/// "RUNNING", "POWER_OFF"; "UNKNOWN" for a number that has no name.
std::string_view name_of(RobotMode mode);
std::string_view name_of(SafetyMode mode);
std::string_view name_of(RuntimeState state);

/// Bits of robot_status_bits.
inline constexpr std::uint32_t kStatusPowerOn = 1U << 0;
inline constexpr std::uint32_t kStatusProgramRunning = 1U << 1;
inline constexpr std::uint32_t kStatusTeachButton = 1U << 2;  ///< pressed: freedrive

/// Bits of safety_status_bits: 0 normal, 1 reduced, 2 protective, 3 recovery, 4 safeguard, 5 system
/// and 6 robot emergency stop, 7 any emergency stop, 8 violation, 9 fault, 10 stopped by any.
std::uint32_t safety_status_bits(SafetyMode mode);

/// The arm may be moved: normal or reduced.
bool allows_motion(SafetyMode mode);

bool is_emergency_stop(SafetyMode mode);

}  // namespace glint
