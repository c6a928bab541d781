// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hardware/robot/protocol/rtde_field.h"

namespace glint {

class TwinController;

/// What a twin tells by RTDE.
class ControllerOutputs {
 public:
  explicit ControllerOutputs(const TwinController& twin) : twin_(twin) {}

  /// None: NOT_FOUND.
  std::optional<RtdeType> type_of(std::string_view name) const;
  std::optional<RtdeValue> value_of(std::string_view name) const;

 private:
  std::array<double, 6> tool_speed() const;  ///< of the TCP in the base, m/s and rad/s
  std::uint32_t status_bits() const;
  RtdeValue plain_value_of(std::string_view name) const;

  const TwinController& twin_;
};

/// "output_int_register_17" -> 17
std::size_t register_number(std::string_view name);

}  // namespace glint
