// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace glint {

/// What can be made to go wrong with a twin.
enum class FaultKind {
  kProtectiveStop,
  kEmergencyStop,
  kSafeguardStop,
  kJointLimit,   ///< the program ends with the controller's message
  kSingular,     ///< the same
  kUnreachable,  ///< the same
  kOverspeed,    ///< the tool is told to be faster than it is
  kSilence,      ///< RTDE stays open and sends nothing
  kCut,          ///< all connections are closed; new ones are taken
  kRestart,    ///< all connections are closed, the clock begins anew, new ones are taken after 1 s
  kSplit,      ///< everything is sent byte by byte
  kOldStamps,  ///< RTDE goes on with one and the same package
  kWrongTcp,   ///< the pendant's TCP is 10 mm longer
  kWrongPayload,
  kRemoteOff,     ///< e-Series: scripts are not taken
  kOtherProgram,  ///< a program of the pendant runs
  kRelease        ///< takes back what can be taken back: emergency stop, safeguard, silence ...
};

inline constexpr std::array<std::string_view, 17> kFaultNames = {"protective_stop",
                                                                 "emergency_stop",
                                                                 "safeguard_stop",
                                                                 "joint_limit",
                                                                 "singular",
                                                                 "unreachable",
                                                                 "overspeed",
                                                                 "silence",
                                                                 "cut",
                                                                 "restart",
                                                                 "split",
                                                                 "old_stamps",
                                                                 "wrong_tcp",
                                                                 "wrong_payload",
                                                                 "remote_off",
                                                                 "other_program",
                                                                 "release"};

/// A fault and its moment.
struct Fault {
  enum class When { kNow, kMoving, kStill };

  FaultKind kind = FaultKind::kProtectiveStop;
  When when = When::kNow;
  double delay_s = 0.0;  ///< counted from the first cycle in which the arm moves, or stands still
};

/// "protective_stop", "protective_stop moving 0.3", "emergency_stop still 0.1".
/// @return none for another text
std::optional<Fault> parse_fault(std::string_view text);

}  // namespace glint
