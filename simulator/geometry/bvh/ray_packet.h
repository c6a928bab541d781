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

/// Sixteen rays that Bvh::trace16() traces where they stand: in the order of Embree's RTCRayHit16,
/// so that nothing need be copied for it. To trace further rays set everything down to t_max and
/// forget what was met (triangle and geometry -1); the rest stays.
struct alignas(64) RayQuery {
  using Floats = std::array<float, kPacketSize>;
  using Integers = std::array<std::int32_t, kPacketSize>;
  static constexpr Integers kNone = {
      -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};

  alignas(64) Floats origin_x = {};
  alignas(64) Floats origin_y = {};
  alignas(64) Floats origin_z = {};
  alignas(64) Floats t_min = {};
  alignas(64) Floats direction_x = {};
  alignas(64) Floats direction_y = {};
  alignas(64) Floats direction_z = {};
  alignas(64) Floats time = {};
  alignas(64) Floats t_max = {};  ///< afterwards: where the ray met the mesh
  alignas(64) Integers mask = kNone;
  alignas(64) Integers id = {};
  alignas(64) Integers flags = {};
  alignas(64) Floats normal_x = {};  ///< out: of the triangle, not unit
  alignas(64) Floats normal_y = {};
  alignas(64) Floats normal_z = {};
  alignas(64) Floats u = {};  ///< out
  alignas(64) Floats v = {};
  alignas(64) Integers triangle = kNone;  ///< out; stays -1 for a miss and for rays left out
  alignas(64) Integers geometry = kNone;
  alignas(64) Integers instance = kNone;
  alignas(64) Integers valid = {};  ///< -1 trace, 0 leave out; not Embree's
};

/// Where sixteen rays met the mesh; triangle < 0 for a miss and for rays that were left out.
struct alignas(64) HitPacket {
  alignas(64) std::array<float, kPacketSize> t_mm = {};
  alignas(64) std::array<std::int32_t, kPacketSize> triangle = {};
  alignas(64) std::array<float, kPacketSize> u = {};
  alignas(64) std::array<float, kPacketSize> v = {};
};

}  // namespace glint
