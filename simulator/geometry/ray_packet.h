// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sixteen rays and what they met, free of Eigen so that kernels can include it.
#pragma once

#include <array>
#include <cstdint>

namespace glint {

inline constexpr int kPacketSize = 16;

/// Sixteen rays, one array per component. Directions need not be unit; t counts in directions.
struct alignas(64) RayPacket {
  alignas(64) std::array<float, kPacketSize> origin_x = {};
  alignas(64) std::array<float, kPacketSize> origin_y = {};
  alignas(64) std::array<float, kPacketSize> origin_z = {};
  alignas(64) std::array<float, kPacketSize> direction_x = {};
  alignas(64) std::array<float, kPacketSize> direction_y = {};
  alignas(64) std::array<float, kPacketSize> direction_z = {};
  alignas(64) std::array<float, kPacketSize> t_min = {};
  alignas(64) std::array<float, kPacketSize> t_max = {};
  alignas(64) std::array<std::int32_t, kPacketSize> valid = {};  ///< -1 trace, 0 leave out
};

/// Where sixteen rays met the mesh; triangle < 0 for a miss and for rays that were left out.
struct alignas(64) HitPacket {
  alignas(64) std::array<float, kPacketSize> t_mm = {};
  alignas(64) std::array<std::int32_t, kPacketSize> triangle = {};
  alignas(64) std::array<float, kPacketSize> u = {};
  alignas(64) std::array<float, kPacketSize> v = {};
};

}  // namespace glint
