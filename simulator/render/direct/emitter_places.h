// SPDX-License-Identifier: GPL-3.0-or-later
//
// Luminous surfaces as a point of metal sees them, in float and free of Eigen.
#pragma once

#include "core/simd.h"

namespace glint {

/// A luminous surface in the frame of a point (simulator/material/local.h), which is its origin.
/// Its places have two coordinates s and t in [0, 1]:
///
///   flat   p = origin + s x + t y + s t z
///   ring   p = origin + r (x cos phi + y sin phi) + h z, r and h linear in s, phi in t
///   cap    the same on a sphere, the angle from z linear in s
struct LocalEmitter {
  enum class Kind { kFlat, kRing, kCap };

  Kind kind = Kind::kFlat;
  float origin[3] = {};  ///< [mm]
  float x[3] = {};
  float y[3] = {};
  float z[3] = {};
  float normal[3] = {};      ///< of a flat one
  float area_mm2 = 0.0F;     ///< per s and t at s = 0, of a flat one
  float area_per_s = 0.0F;   ///< what is added towards s = 1
  float radius_mm = 0.0F;    ///< of a ring's middle, or a cap's sphere
  float width_mm = 0.0F;     ///< of a ring, along its slope
  float tilt_cosine = 1.0F;  ///< of a ring
  float tilt_sine = 0.0F;
  float first_rad = 0.0F;  ///< phi at t = 0
  float span_rad = 0.0F;
  float top_rad = 0.0F;     ///< angle from z at s = 0, of a cap
  float height_rad = 0.0F;  ///< from there to s = 1
  float exponent = 1.0F;    ///< of the lobe; 1: Lambertian
  float strongest = 1.0F;   ///< largest radiance of its channels
};

/// The places with s, t no further than half_s, half_t from a middle.
struct Panel {
  float s = 0.5F;
  float t = 0.5F;
  float half_s = 0.5F;
  float half_t = 0.5F;
};

struct PlaceVector {
  float x, y, z;
};

GLINT_INLINE PlaceVector vector_of(const float* v) {
  return {v[0], v[1], v[2]};
}

GLINT_INLINE PlaceVector operator+(PlaceVector a, PlaceVector b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

GLINT_INLINE PlaceVector operator-(PlaceVector a, PlaceVector b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

GLINT_INLINE PlaceVector operator*(float f, PlaceVector a) {
  return {f * a.x, f * a.y, f * a.z};
}

GLINT_INLINE float dot(PlaceVector a, PlaceVector b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A place on a surface, its normal, and the area it stands for per s and t.
struct EmitterPlace {
  PlaceVector point, normal;
  float area_mm2;
};

/// What s alone says of a place on a ring or a cap.
struct RoundProfile {
  float r_mm, h_mm;  ///< from and along the axis
  float nr, nz;      ///< of the normal
  float area_mm2;    ///< per s and t
};

RoundProfile profile_at(const LocalEmitter& emitter, float s);

/// What t alone says: the direction away from the axis.
PlaceVector radial_at(const LocalEmitter& emitter, float t);

EmitterPlace flat_place(const LocalEmitter& emitter, float s, float t);
EmitterPlace round_place(const LocalEmitter& emitter,
                         const RoundProfile& profile,
                         PlaceVector radial);

}  // namespace glint
