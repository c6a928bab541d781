// SPDX-License-Identifier: GPL-3.0-or-later
//
// Values of RTDE and their types.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "hardware/robot/protocol/byte_order.h"

namespace glint {

/// In the order of kRtdeTypeNames and of the alternatives of RtdeValue.
enum class RtdeType {
  kBool,
  kUint8,
  kUint32,
  kUint64,
  kInt32,
  kDouble,
  kVector3d,
  kVector6d,
  kVector6int32,
  kVector6uint32
};

inline constexpr std::array<std::string_view, 10> kRtdeTypeNames = {"BOOL",
                                                                    "UINT8",
                                                                    "UINT32",
                                                                    "UINT64",
                                                                    "INT32",
                                                                    "DOUBLE",
                                                                    "VECTOR3D",
                                                                    "VECTOR6D",
                                                                    "VECTOR6INT32",
                                                                    "VECTOR6UINT32"};

using RtdeValue = std::variant<bool,
                               std::uint8_t,
                               std::uint32_t,
                               std::uint64_t,
                               std::int32_t,
                               double,
                               std::array<double, 3>,
                               std::array<double, 6>,
                               std::array<std::int32_t, 6>,
                               std::array<std::uint32_t, 6>>;

/// None for a name that is no type, as NOT_FOUND and IN_USE.
std::optional<RtdeType> rtde_type(std::string_view name);

std::string_view name_of(RtdeType type);

/// Bytes of a value of that type.
std::size_t size_of(RtdeType type);

RtdeType type_of(const RtdeValue& value);

void put(ByteWriter& writer, const RtdeValue& value);
RtdeValue take(ByteReader& reader, RtdeType type);

/// The type that controllers give an output of that name; none for a name that Glint does not know.
/// Registers: output_int_register_0 to 47, output_double_register_0 to 47.
std::optional<RtdeType> output_type(std::string_view name);

/// The same of inputs: digital outputs with their mask, registers.
std::optional<RtdeType> input_type(std::string_view name);

/// "a,b,c" at its commas; an empty text has no parts.
std::vector<std::string> split_names(std::string_view names);
std::string joined_names(const std::vector<std::string>& names);

}  // namespace glint
