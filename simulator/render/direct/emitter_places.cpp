// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/direct/emitter_places.h"

#include <cmath>

namespace glint {

RoundProfile profile_at(const LocalEmitter& e, float s) {
  if (e.kind == LocalEmitter::Kind::kRing) {
    const float along = (s - 0.5F) * e.width_mm;
    const float r = e.radius_mm + along * e.tilt_cosine;
    return {.r_mm = r,
            .h_mm = along * e.tilt_sine,
            .nr = -e.tilt_sine,
            .nz = e.tilt_cosine,
            .area_mm2 = r * e.width_mm * e.span_rad};
  }
  const float angle = e.top_rad + s * e.height_rad;
  const float sine = std::sin(angle);
  const float cosine = std::cos(angle);
  return {.r_mm = e.radius_mm * sine,
          .h_mm = e.radius_mm * cosine,
          .nr = -sine,
          .nz = -cosine,
          .area_mm2 = e.radius_mm * e.radius_mm * sine * e.height_rad * e.span_rad};
}

PlaceVector radial_at(const LocalEmitter& e, float t) {
  const float phi = e.first_rad + t * e.span_rad;
  return std::cos(phi) * vector_of(e.x) + std::sin(phi) * vector_of(e.y);
}

EmitterPlace flat_place(const LocalEmitter& e, float s, float t) {
  return {.point = vector_of(e.origin) + s * vector_of(e.x) + t * vector_of(e.y) +
                   (s * t) * vector_of(e.z),
          .normal = vector_of(e.normal),
          .area_mm2 = e.area_mm2 + s * e.area_per_s};
}

EmitterPlace round_place(const LocalEmitter& e, const RoundProfile& profile, PlaceVector radial) {
  return {.point = vector_of(e.origin) + profile.r_mm * radial + profile.h_mm * vector_of(e.z),
          .normal = profile.nr * radial + profile.nz * vector_of(e.z),
          .area_mm2 = profile.area_mm2};
}

}  // namespace glint
