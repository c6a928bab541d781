// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sixteen paths and what is known of them at a step, one array per component, in float.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simulator/geometry/bvh/ray_packet.h"

namespace glint {

/// Rays of a packet, for loops over arrays.
inline constexpr std::size_t kPacketLanes = kPacketSize;

struct alignas(64) VectorLanes {
  float x[kPacketSize];
  float y[kPacketSize];
  float z[kPacketSize];
};

struct alignas(64) ColourLanes {
  float c[3][kPacketSize];
};

/// Paths on their way: valid lanes of the ray go on.
struct alignas(64) PathPacket {
  RayPacket ray;
  HitPacket hit;
  ColourLanes weight;
  float density[kPacketSize];  ///< with which the ray was chosen; 0: by a mirror or the camera
  std::uint32_t seed[kPacketSize];
  std::uint32_t index[kPacketSize];  ///< of the sample
  std::uint32_t path[kPacketSize];   ///< number among the paths that are followed together
};

/// Where rays met the part, as ShadingPoint.
struct alignas(64) SurfaceLanes {
  VectorLanes point;
  VectorLanes start;
  VectorLanes side;
  VectorLanes tangent, bitangent, normal;
  VectorLanes viewer;  ///< local
  VectorLanes open;    ///< a ray that leaves towards this half space meets the part no more
  float tilt[kPacketSize];
  float reflectance[kPacketSize];
  std::int32_t defect[kPacketSize];
};

/// Six random numbers of a reflection.
struct alignas(64) RandomLanes {
  float light_u[kPacketSize], light_v[kPacketSize];
  float lobe_u[kPacketSize], lobe_v[kPacketSize];
  float choice[kPacketSize], roulette[kPacketSize];
};

/// Directions drawn towards lights; density 0: none.
struct alignas(64) LightLanes {
  VectorLanes direction;
  float distance[kPacketSize];
  ColourLanes radiance;
  float density[kPacketSize];
  std::int32_t group[kPacketSize];
};

/// Lights that rays met.
struct alignas(64) LightHitLanes {
  std::int32_t is_hit[kPacketSize];
  float cosine[kPacketSize];   ///< <= 0: a back
  float density[kPacketSize];  ///< with which the direction is drawn towards lights
  ColourLanes radiance;
  std::int32_t group[kPacketSize];
};

/// What a material does with the drawn directions.
struct alignas(64) ReflectionLanes {
  ColourLanes value;
  float density[kPacketSize];
};

/// Directions chosen by a material; weight 0: lost, density 0: a mirror's.
struct alignas(64) LeavingLanes {
  VectorLanes to_light;  ///< local
  ColourLanes weight;
  float density[kPacketSize];
};

/// Radiance that reaches the camera if nothing is in the way.
struct alignas(64) ArrivingLanes {
  ColourLanes radiance;
  std::int32_t is_bright[kPacketSize];  ///< 0: black, or not asked for
  std::int32_t is_open[kPacketSize];    ///< nothing can be in the way
};

}  // namespace glint
