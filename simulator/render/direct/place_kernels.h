// SPDX-License-Identifier: GPL-3.0-or-later
//
// The light that sixteen places on lights send to a point of metal, in float and free of Eigen.
#pragma once

#include "simulator/render/direct/emitter_places.h"
#include "simulator/render/path_tracing/conductor_kernels.h"

namespace glint {

/// Places along one coordinate of a panel at most.
inline constexpr int kMaxPlaces = 8;

/// Sixteen places on luminous surfaces.
struct alignas(64) PlaceLanes {
  VectorLanes point;   ///< local [mm]
  VectorLanes normal;  ///< local, unit
  float area_mm2[kPacketSize];
  float exponent[kPacketSize];
  std::int32_t emitter[kPacketSize];
};

/// A place for each node of the product rule, from `first` on; s changes slowest.
/// @param count_s, count_t  in [1, kMaxPlaces]
/// @param places  its element `lane` of packet `packet` is 16 packet + lane
void place_nodes(const LocalEmitter& emitter,
                 const Panel& panel,
                 int count_s,
                 int count_t,
                 int index,
                 int first,
                 PlaceLanes* places);

/// Of sixteen places: directions and what light of radiance 1 from there adds to the radiance.
struct alignas(64) LitLanes {
  VectorLanes direction;  ///< local
  float distance_mm[kPacketSize];
  float solid_angle[kPacketSize];  ///< times the lobe's profile; 0: a back, or below the horizon
  ReflectionLanes reflection;
};

/// @param has_lobes  false: all exponents are 1
void light_places16(const ConductorNumbers& metal,
                    const LobeLanes& lobes,
                    const VectorLanes& viewer,
                    const float* side,
                    bool has_lobes,
                    const PlaceLanes& places,
                    LitLanes& lit);

}  // namespace glint
