// SPDX-License-Identifier: GPL-3.0-or-later
//
// Up to eight rings, discs or sectors of them, flat or tilted, as lights (simulator/light/area) for
// sixteen points or rays at a time in float.
#pragma once

#include "simulator/render/path_tracing/path_packet.h"

namespace glint {

/// The emitters as plain numbers, one array per component.
struct RingLights {
  static constexpr int kMost = 8;

  int count = 0;
  float origin_x[kMost] = {}, origin_y[kMost] = {}, origin_z[kMost] = {};
  float x_x[kMost] = {}, x_y[kMost] = {}, x_z[kMost] = {};
  float y_x[kMost] = {}, y_y[kMost] = {}, y_z[kMost] = {};
  float z_x[kMost] = {}, z_y[kMost] = {}, z_z[kMost] = {};
  float inner_squared[kMost] = {};  ///< [mm2]
  float outer_squared[kMost] = {};
  float first_turns[kMost] = {};  ///< of a sector, in [0, 1)
  float span_turns[kMost] = {};
  float first_cosine[kMost] = {};
  float first_sine[kMost] = {};
  float span_pseudo[kMost] = {};  ///< pseudo angle of the span, >= 4: a whole ring
  float middle[kMost] = {};       ///< radius [mm]
  float width[kMost] = {};        ///< along the slope [mm]
  float tilt_cosine[kMost] = {};
  float tilt_sine[kMost] = {};         ///< 0: flat
  std::int32_t same_cone[kMost] = {};  ///< 1: another sector of the cone of the emitter before
  bool has_tilts = false;              ///< some are not flat
  float per_area[kMost] = {};          ///< 1 / mm2
  float radiance[3][kMost] = {};
  float exponent[kMost] = {};  ///< of the radiance: that of the lobe less 1
  float solid[kMost] = {};     ///< 1: the back hides what is behind
  bool has_lobes = false;      ///< some exponent is not 0
  std::int32_t group[kMost] = {};

  // What LightTree weighs emitters by.
  float box_x[kMost] = {}, box_y[kMost] = {}, box_z[kMost] = {};
  float box_radius[kMost] = {};
  float intensity[kMost] = {};
  float axis_x[kMost] = {}, axis_y[kMost] = {}, axis_z[kMost] = {};  ///< of the cone of normals
  float cone_cosine[kMost] = {}, cone_sine[kMost] = {};              ///< of its half angle
};

/// As sample_light(), and is_hidden(): hidden directions have density 0.
void sample_rings16(const RingLights& rings,
                    const VectorLanes& points,
                    const RandomLanes& random,
                    LightLanes& lights);

/// As hit_light() of valid rays before what they hit, and light_density().
void hit_rings16(const RingLights& rings,
                 const RayPacket& rays,
                 const HitPacket& hits,
                 LightHitLanes& lights);

}  // namespace glint
