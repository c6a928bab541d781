// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/protocol/rtde_package.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hardware/robot/protocol/byte_order.h"

namespace glint {
namespace {

constexpr std::size_t kHeadBytes = 3;
constexpr std::size_t kMaxShown = 255;

void check(bool holds, const std::string& text) {
  if (!holds) {
    throw ProtocolError("RTDE: " + text);
  }
}

bool is_printable(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c >= 0x20 && c < 0x7f; });
}

}  // namespace

std::string rtde_package(RtdeKind kind, std::string_view payload) {
  GLINT_CHECK(payload.size() + kHeadBytes <= 65535, "an RTDE package has at most 65535 bytes");
  ByteWriter writer;
  writer.put(static_cast<std::uint16_t>(payload.size() + kHeadBytes));
  writer.put(static_cast<std::uint8_t>(kind));
  writer.put(payload);
  return writer.bytes();
}

std::string ControllerVersion::text() const {
  return fmt::format("{}.{}.{}.{}", major, minor, bugfix, build);
}

std::size_t RtdeRecipe::size_bytes() const {
  std::size_t bytes = 0;
  for (const RtdeType type : types) {
    bytes += size_of(type);
  }
  return bytes;
}

std::string version_request(std::uint16_t version) {
  ByteWriter writer;
  writer.put(version);
  return rtde_package(RtdeKind::kProtocolVersion, writer.bytes());
}

std::string controller_version_request() {
  return rtde_package(RtdeKind::kControllerVersion, {});
}

std::string outputs_request(double frequency_hz, const std::vector<std::string>& names) {
  ByteWriter writer;
  writer.put(frequency_hz);
  writer.put(joined_names(names));
  return rtde_package(RtdeKind::kOutputs, writer.bytes());
}

std::string inputs_request(const std::vector<std::string>& names) {
  return rtde_package(RtdeKind::kInputs, joined_names(names));
}

std::string start_request() {
  return rtde_package(RtdeKind::kStart, {});
}

std::string data_package(std::uint8_t recipe, const std::vector<RtdeValue>& values) {
  ByteWriter writer;
  writer.put(recipe);
  for (const RtdeValue& value : values) {
    put(writer, value);
  }
  return rtde_package(RtdeKind::kData, writer.bytes());
}

std::string flag_reply(RtdeKind kind, bool is_accepted) {
  return rtde_package(kind, std::string_view(is_accepted ? "\1" : "\0", 1));
}

std::string controller_version_reply(const ControllerVersion& version) {
  ByteWriter writer;
  for (const std::uint32_t number : {version.major, version.minor, version.bugfix, version.build}) {
    writer.put(number);
  }
  return rtde_package(RtdeKind::kControllerVersion, writer.bytes());
}

std::string recipe_reply(RtdeKind kind, const RecipeReply& reply) {
  ByteWriter writer;
  writer.put(reply.id);
  writer.put(joined_names(reply.types));
  return rtde_package(kind, writer.bytes());
}

std::string text_package(const RtdeText& text) {
  ByteWriter writer;
  for (const std::string& part : {text.message, text.source}) {
    const std::string_view shown = std::string_view(part).substr(0, kMaxShown);
    writer.put(static_cast<std::uint8_t>(shown.size()));
    writer.put(shown);
  }
  writer.put(text.level);
  return rtde_package(RtdeKind::kText, writer.bytes());
}

bool parse_flag(std::string_view payload) {
  check(payload.size() == 1, fmt::format("a reply of {} bytes, must have 1", payload.size()));
  return payload[0] != '\0';
}

ControllerVersion parse_controller_version(std::string_view payload) {
  ByteReader reader(payload);
  ControllerVersion version;
  version.major = reader.take<std::uint32_t>();
  version.minor = reader.take<std::uint32_t>();
  version.bugfix = reader.take<std::uint32_t>();
  version.build = reader.take<std::uint32_t>();
  check(reader.is_exact(),
        fmt::format("a controller version of {} bytes, must have 16", payload.size()));
  return version;
}

RecipeReply parse_recipe_reply(std::string_view payload) {
  ByteReader reader(payload);
  RecipeReply reply = {.id = reader.take<std::uint8_t>(), .types = split_names(reader.rest())};
  check(!reader.is_short() && !reply.types.empty(), "a reply to a recipe without types");
  for (const std::string& type : reply.types) {
    check(rtde_type(type).has_value() || type == "NOT_FOUND" || type == "IN_USE",
          fmt::format("\"{}\" in a reply to a recipe is no type",
                      is_printable(type) ? type.substr(0, 40) : "?"));
  }
  return reply;
}

RtdeText parse_text(std::string_view payload) {
  ByteReader reader(payload);
  RtdeText text;
  text.message = reader.take_text(reader.take<std::uint8_t>());
  text.source = reader.take_text(reader.take<std::uint8_t>());
  text.level = reader.take<std::uint8_t>();
  check(reader.is_exact(), "a text whose lengths do not add up");
  return text;
}

std::vector<RtdeValue> parse_data(std::string_view payload, const RtdeRecipe& recipe) {
  ByteReader reader(payload);
  const auto id = reader.take<std::uint8_t>();
  check(id == recipe.id && !payload.empty(),
        fmt::format("data of recipe {}, asked was for {}", id, recipe.id));
  check(
      payload.size() == 1 + recipe.size_bytes(),
      fmt::format("data of {} bytes, the recipe has {}", payload.size(), 1 + recipe.size_bytes()));
  std::vector<RtdeValue> values;
  values.reserve(recipe.types.size());
  for (const RtdeType type : recipe.types) {
    values.push_back(take(reader, type));
  }
  return values;
}

}  // namespace glint
