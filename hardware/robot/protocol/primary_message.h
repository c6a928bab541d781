// SPDX-License-Identifier: GPL-3.0-or-later
//
// Messages of the primary interface (TCP 30001) that tell why a program ended. Only those are read;
// states, which come ten times a second, are skipped.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace glint {

inline constexpr std::uint8_t kPrimaryState = 16;
inline constexpr std::uint8_t kPrimaryRobotMessage = 20;

/// A robot message: uint64 stamp, int8 source, int8 kind, then what the kind has.
struct PrimaryMessage {
  enum class Kind : std::int8_t { kText = 0, kErrorCode = 6, kKey = 7, kRuntimeException = 10 };

  std::uint64_t stamp_us = 0;
  Kind kind = Kind::kText;
  std::int32_t code = 0;  ///< of an error; line of a runtime exception
  std::int32_t argument = 0;
  std::string text;
};

/// @param kind     of the frame
/// @param payload  of the frame
/// @return none for a frame that is no such message
/// @throws ProtocolError for one that is too short
std::optional<PrimaryMessage> parse_primary(std::uint8_t kind, std::string_view payload);

/// The whole frame.
std::string primary_frame(const PrimaryMessage& message);

/// A state frame with the part "robot mode data" alone, as a client that waits for life needs it.
std::string primary_state_frame(std::uint64_t stamp_us,
                                bool is_power_on,
                                bool is_program_running,
                                std::uint8_t robot_mode);

}  // namespace glint
