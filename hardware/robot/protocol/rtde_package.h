// SPDX-License-Identifier: GPL-3.0-or-later
//
// Packages of RTDE, protocol version 2 (TCP 30004), both ways. Every function takes or gives the
// bytes of one package; FrameSplitter cuts a stream into payloads.
//
// Source: the maker's guide to RTDE; fields and replies checked with its Python client.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hardware/robot/protocol/message_splitter.h"
#include "hardware/robot/protocol/rtde_field.h"

namespace glint {

enum class RtdeKind : std::uint8_t {
  kProtocolVersion = 'V',
  kControllerVersion = 'v',
  kText = 'M',
  kData = 'U',
  kOutputs = 'O',
  kInputs = 'I',
  kStart = 'S',
  kPause = 'P'
};

/// A controller takes at most so many bytes of names in a recipe.
inline constexpr std::size_t kMaxRecipeBytes = 2048;

/// The whole package: length, kind, payload of at most 65,532 bytes.
std::string rtde_package(RtdeKind kind, std::string_view payload);

struct ControllerVersion {
  std::uint32_t major = 0;
  std::uint32_t minor = 0;
  std::uint32_t bugfix = 0;
  std::uint32_t build = 0;

  std::string text() const;  ///< "5.11.4.108"
};

/// What a controller makes of a recipe: its number, and a type, NOT_FOUND or IN_USE for each name.
struct RecipeReply {
  std::uint8_t id = 0;
  std::vector<std::string> types;
};

/// A recipe whose types are known.
struct RtdeRecipe {
  std::uint8_t id = 0;
  std::vector<std::string> names;
  std::vector<RtdeType> types;

  std::size_t size_bytes() const;  ///< of the values of one package
};

struct RtdeText {
  std::string message;
  std::string source;
  std::uint8_t level = 3;  ///< 0 exception, 1 error, 2 warning, 3 info
};

std::string version_request(std::uint16_t version = 2);
std::string controller_version_request();
std::string outputs_request(double frequency_hz, const std::vector<std::string>& names);
std::string inputs_request(const std::vector<std::string>& names);
std::string start_request();
std::string data_package(std::uint8_t recipe, const std::vector<RtdeValue>& values);

std::string flag_reply(RtdeKind kind, bool is_accepted);
std::string controller_version_reply(const ControllerVersion& version);
std::string recipe_reply(RtdeKind kind, const RecipeReply& reply);
std::string text_package(const RtdeText& text);

/// Payloads. All throw ProtocolError for one that is too short, too long or of other values than
/// the protocol allows.
bool parse_flag(std::string_view payload);
ControllerVersion parse_controller_version(std::string_view payload);
RecipeReply parse_recipe_reply(std::string_view payload);
RtdeText parse_text(std::string_view payload);

/// @param recipe  of the package
std::vector<RtdeValue> parse_data(std::string_view payload, const RtdeRecipe& recipe);

}  // namespace glint
