// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/protocol/rtde_field.h"

#include <algorithm>
#include <charconv>

namespace glint {
namespace {

struct NamedType {
  std::string_view name;
  RtdeType type;
};

// Source: the maker's guide to RTDE; compared with the field tables of public clients.
constexpr std::array<NamedType, 27> kOutputs = {{
    {"timestamp", RtdeType::kDouble},
    {"target_q", RtdeType::kVector6d},
    {"target_qd", RtdeType::kVector6d},
    {"actual_q", RtdeType::kVector6d},
    {"actual_qd", RtdeType::kVector6d},
    {"actual_TCP_pose", RtdeType::kVector6d},
    {"actual_TCP_speed", RtdeType::kVector6d},
    {"target_TCP_pose", RtdeType::kVector6d},
    {"target_TCP_speed", RtdeType::kVector6d},
    {"actual_digital_input_bits", RtdeType::kUint64},
    {"actual_digital_output_bits", RtdeType::kUint64},
    {"joint_temperatures", RtdeType::kVector6d},
    {"actual_execution_time", RtdeType::kDouble},
    {"robot_mode", RtdeType::kInt32},
    {"joint_mode", RtdeType::kVector6int32},
    {"safety_mode", RtdeType::kInt32},
    {"safety_status", RtdeType::kInt32},
    {"speed_scaling", RtdeType::kDouble},
    {"target_speed_fraction", RtdeType::kDouble},
    {"runtime_state", RtdeType::kUint32},
    {"robot_status_bits", RtdeType::kUint32},
    {"safety_status_bits", RtdeType::kUint32},
    {"tcp_offset", RtdeType::kVector6d},
    {"payload", RtdeType::kDouble},
    {"payload_cog", RtdeType::kVector3d},
    {"output_bit_registers0_to_31", RtdeType::kUint32},
    {"output_bit_registers32_to_63", RtdeType::kUint32},
}};

constexpr std::array<NamedType, 4> kInputs = {{
    {"standard_digital_output_mask", RtdeType::kUint8},
    {"standard_digital_output", RtdeType::kUint8},
    {"speed_slider_mask", RtdeType::kUint32},
    {"speed_slider_fraction", RtdeType::kDouble},
}};

constexpr int kNumRegisters = 48;

template <std::size_t Size>
std::optional<RtdeType> type_in(const std::array<NamedType, Size>& table, std::string_view name) {
  const auto found = std::ranges::find(table, name, &NamedType::name);
  return found == table.end() ? std::nullopt : std::optional(found->type);
}

bool is_register(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix)) {
    return false;
  }
  name.remove_prefix(prefix.size());
  int number = -1;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  return error == std::errc() && end == name.data() + name.size() && number >= 0 &&
         number < kNumRegisters;
}

template <std::size_t... Index>
RtdeValue default_value(RtdeType type, std::index_sequence<Index...>) {
  RtdeValue value;
  static_cast<void>(
      ((static_cast<std::size_t>(type) == Index ? (value.emplace<Index>(), true) : false) || ...));
  return value;
}

void put_one(ByteWriter& writer, bool value) {
  writer.put(static_cast<std::uint8_t>(value ? 1 : 0));
}

template <class Number>
void put_one(ByteWriter& writer, Number value) {
  writer.put(value);
}

template <class Number, std::size_t Size>
void put_one(ByteWriter& writer, const std::array<Number, Size>& values) {
  for (const Number value : values) {
    writer.put(value);
  }
}

void take_one(ByteReader& reader, bool& value) {
  value = reader.take<std::uint8_t>() != 0;
}

void take_one(ByteReader& reader, double& value) {
  value = reader.take_double();
}

template <std::integral Number>
void take_one(ByteReader& reader, Number& value) {
  value = reader.take<Number>();
}

template <class Number, std::size_t Size>
void take_one(ByteReader& reader, std::array<Number, Size>& values) {
  for (Number& value : values) {
    take_one(reader, value);
  }
}

}  // namespace

std::optional<RtdeType> rtde_type(std::string_view name) {
  const auto found = std::ranges::find(kRtdeTypeNames, name);
  return found == kRtdeTypeNames.end()
             ? std::nullopt
             : std::optional(static_cast<RtdeType>(found - kRtdeTypeNames.begin()));
}

std::string_view name_of(RtdeType type) {
  return kRtdeTypeNames.at(static_cast<std::size_t>(type));
}

std::size_t size_of(RtdeType type) {
  constexpr std::array<std::size_t, kRtdeTypeNames.size()> kSizes = {
      1, 1, 4, 8, 4, 8, 24, 48, 24, 24};
  return kSizes.at(static_cast<std::size_t>(type));
}

RtdeType type_of(const RtdeValue& value) {
  return static_cast<RtdeType>(value.index());
}

void put(ByteWriter& writer, const RtdeValue& value) {
  std::visit([&writer](const auto& held) { put_one(writer, held); }, value);
}

RtdeValue take(ByteReader& reader, RtdeType type) {
  RtdeValue value = default_value(type, std::make_index_sequence<std::variant_size_v<RtdeValue>>());
  std::visit([&reader](auto& held) { take_one(reader, held); }, value);
  return value;
}

std::optional<RtdeType> output_type(std::string_view name) {
  if (is_register(name, "output_int_register_")) {
    return RtdeType::kInt32;
  }
  if (is_register(name, "output_double_register_")) {
    return RtdeType::kDouble;
  }
  return type_in(kOutputs, name);
}

std::optional<RtdeType> input_type(std::string_view name) {
  if (is_register(name, "input_int_register_")) {
    return RtdeType::kInt32;
  }
  if (is_register(name, "input_double_register_")) {
    return RtdeType::kDouble;
  }
  return type_in(kInputs, name);
}

std::vector<std::string> split_names(std::string_view names) {
  std::vector<std::string> parts;
  while (!names.empty()) {
    const std::size_t comma = names.find(',');
    parts.emplace_back(names.substr(0, comma));
    names = comma == std::string_view::npos ? std::string_view() : names.substr(comma + 1);
  }
  return parts;
}

std::string joined_names(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) {
    joined += (joined.empty() ? "" : ",") + name;
  }
  return joined;
}

}  // namespace glint
