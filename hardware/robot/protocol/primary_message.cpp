// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/protocol/primary_message.h"

#include <algorithm>

#include "hardware/robot/protocol/byte_order.h"
#include "hardware/robot/protocol/message_splitter.h"

namespace glint {
namespace {

constexpr std::int8_t kFromController = -1;
constexpr std::size_t kMaxText = 1000;

bool is_read(PrimaryMessage::Kind kind) {
  using enum PrimaryMessage::Kind;
  return kind == kText || kind == kErrorCode || kind == kKey || kind == kRuntimeException;
}

/// Texts of a peer reach the screen: what is no plain character becomes a question mark.
std::string plain(std::string_view text) {
  std::string result(text.substr(0, kMaxText));
  std::ranges::replace_if(
      result, [](char c) { return c < 0x20 || c >= 0x7f; }, '?');
  return result;
}

std::string frame(std::uint8_t kind, std::string_view payload) {
  ByteWriter writer;
  writer.put(static_cast<std::uint32_t>(payload.size() + 5));
  writer.put(kind);
  writer.put(payload);
  return writer.bytes();
}

/// What stands between the kind of a message and its text.
void take_numbers(ByteReader& reader, PrimaryMessage& message) {
  if (message.kind != PrimaryMessage::Kind::kText) {
    message.code = reader.take<std::int32_t>();
    message.argument = reader.take<std::int32_t>();
  }
  if (message.kind == PrimaryMessage::Kind::kErrorCode ||
      message.kind == PrimaryMessage::Kind::kKey) {
    reader.take_text(message.kind == PrimaryMessage::Kind::kErrorCode ? 12 : 0);
  }
  if (message.kind == PrimaryMessage::Kind::kKey) {
    reader.take_text(reader.take<std::uint8_t>());
  }
}

}  // namespace

std::optional<PrimaryMessage> parse_primary(std::uint8_t kind, std::string_view payload) {
  if (kind != kPrimaryRobotMessage) {
    return std::nullopt;
  }
  ByteReader reader(payload);
  PrimaryMessage message;
  message.stamp_us = reader.take<std::uint64_t>();
  reader.take<std::int8_t>();
  message.kind = static_cast<PrimaryMessage::Kind>(reader.take<std::int8_t>());
  if (!reader.is_short() && !is_read(message.kind)) {
    return std::nullopt;
  }
  take_numbers(reader, message);
  if (reader.is_short()) {
    throw ProtocolError("primary interface: a robot message that is too short");
  }
  message.text = plain(reader.rest());
  return message;
}

std::string primary_frame(const PrimaryMessage& message) {
  ByteWriter writer;
  writer.put(message.stamp_us);
  writer.put(kFromController);
  writer.put(static_cast<std::int8_t>(message.kind));
  if (message.kind != PrimaryMessage::Kind::kText) {
    writer.put(message.code);
    writer.put(message.argument);
  }
  if (message.kind == PrimaryMessage::Kind::kErrorCode) {
    writer.put(std::uint32_t{0});  // level, type and value of the argument
    writer.put(std::uint32_t{0});
    writer.put(std::uint32_t{0});
  }
  if (message.kind == PrimaryMessage::Kind::kKey) {
    writer.put(std::uint8_t{0});  // no title
  }
  writer.put(message.text);
  return frame(kPrimaryRobotMessage, writer.bytes());
}

std::string primary_state_frame(std::uint64_t stamp_us,
                                bool is_power_on,
                                bool is_program_running,
                                std::uint8_t robot_mode) {
  ByteWriter part;
  part.put(stamp_us);
  part.put(std::uint8_t{1});  // real robot connected
  part.put(std::uint8_t{1});  // real robot enabled
  part.put(static_cast<std::uint8_t>(is_power_on ? 1 : 0));
  part.put(std::uint8_t{0});  // emergency stopped
  part.put(std::uint8_t{0});  // protective stopped
  part.put(static_cast<std::uint8_t>(is_program_running ? 1 : 0));
  part.put(std::uint8_t{0});  // program paused
  part.put(robot_mode);
  part.put(std::uint8_t{0});  // control mode
  part.put(1.0);              // target speed fraction
  part.put(1.0);              // speed scaling
  part.put(1.0);              // its limit
  part.put(std::uint8_t{0});
  constexpr std::uint8_t kRobotModeData = 0;
  return frame(kPrimaryState, frame(kRobotModeData, part.bytes()));
}

}  // namespace glint
