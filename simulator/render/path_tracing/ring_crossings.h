// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where sixteen rays meet flat and tilted rings, in float; part of ring_kernels.cpp.
#pragma once

#include "simulator/render/path_tracing/lane_math.h"
#include "simulator/render/path_tracing/ring_kernels.h"

namespace glint {

/// Rays that meet nothing end here.
inline constexpr float kFar_mm = 1e30F;

/// Grows with the angle of (x, y) from +x, 0 to 4 for a turn.
GLINT_INLINE float pseudo_angle(float x, float y) {
  const float share = x / most(std::abs(x) + std::abs(y), 1e-30F);
  return y >= 0.0F ? 1.0F - share : 3.0F + share;
}

/// Where rays meet one ring.
struct alignas(64) RingCrossings {
  float distance[kPacketSize];  ///< kFar_mm: not
  float cosine[kPacketSize];    ///< <= 0: its back
};

/// @param o, d  from and along, three arrays each @param reach  as far as rays go
GLINT_INLINE void cross_ring(const RingLights& r,
                             int e,
                             const float* __restrict ox,
                             const float* __restrict oy,
                             const float* __restrict oz,
                             const float* __restrict dx,
                             const float* __restrict dy,
                             const float* __restrict dz,
                             const float* __restrict reach,
                             RingCrossings* __restrict crossings) {
  for (int i = 0; i < kPacketSize; ++i) {
    const float fx = ox[i] - r.origin_x[e];
    const float fy = oy[i] - r.origin_y[e];
    const float fz = oz[i] - r.origin_z[e];
    const float height = fx * r.z_x[e] + fy * r.z_y[e] + fz * r.z_z[e];
    const float slope = dx[i] * r.z_x[e] + dy[i] * r.z_y[e] + dz[i] * r.z_z[e];
    const float t = -height / (slope != 0.0F ? slope : 1e-30F);
    const float hx = fx + t * dx[i];
    const float hy = fy + t * dy[i];
    const float hz = fz + t * dz[i];
    const float x = hx * r.x_x[e] + hy * r.x_y[e] + hz * r.x_z[e];
    const float y = hx * r.y_x[e] + hy * r.y_y[e] + hz * r.y_z[e];
    const float squared = x * x + y * y;
    const float turned = pseudo_angle(x * r.first_cosine[e] + y * r.first_sine[e],
                                      y * r.first_cosine[e] - x * r.first_sine[e]);
    const bool is_in = both(both(squared >= r.inner_squared[e], squared <= r.outer_squared[e]),
                            turned <= r.span_pseudo[e]);
    const bool is_before = both(t > 0.0F, t < reach[i]);
    const bool is_met = both(both(is_in, is_before), either(slope<0.0F, r.solid[e]> 0.0F));
    crossings->distance[i] = is_met ? t : kFar_mm;
    crossings->cosine[i] = -slope;
  }
}

/// Where rays meet the slope of a tilted ring, whatever the sector: once on each side.
struct alignas(64) ConeCrossings {
  float distance[2][kPacketSize];  ///< kFar_mm: not
  float cosine[2][kPacketSize];    ///< <= 0: its back
  float x[2][kPacketSize];         ///< in the ring's frame
  float y[2][kPacketSize];
};

/// One crossing, moved onto the cone by Newton's method.
struct ConeCrossing {
  float distance, x, y, cosine;
};

/// A ray in a ring's frame.
struct LocalRay {
  float ox, oy, oz;
  float dx, dy, dz;
};

GLINT_INLINE float newton_step(const LocalRay& ray, float c, float s, float m, float t) {
  const float x = ray.ox + t * ray.dx;
  const float y = ray.oy + t * ray.dy;
  const float z = ray.oz + t * ray.dz;
  const float r = most(std::sqrt(x * x + y * y), 1e-30F);
  const float slope = ray.dz * c - s * (x * ray.dx + y * ray.dy) / r;
  return t - (z * c - (r - m) * s) / (slope != 0.0F ? slope : 1e30F);
}

/// As ring_crossing() in emitter_shape.cpp, without the sector.
GLINT_INLINE ConeCrossing
cone_crossing(const LocalRay& ray, float c, float s, float m, float half_width, float start) {
  const float sheet = ((ray.oz + start * ray.dz) * c + m * s) * s;
  const float t = newton_step(ray, c, s, m, newton_step(ray, c, s, m, start));
  const float x = ray.ox + t * ray.dx;
  const float y = ray.oy + t * ray.dy;
  const float r = std::sqrt(x * x + y * y);
  const float along = (r - m) * c + (ray.oz + t * ray.dz) * s;
  const float outwards = (x * ray.dx + y * ray.dy) / most(r, 1e-30F);
  const bool is_met = both(sheet >= 0.0F, std::abs(along) <= half_width);
  return {is_met ? t : kFar_mm, x, y, s * outwards - c * ray.dz};
}

/// The roots of the cone's equation, their discriminant without the cancellation of flat cones.
GLINT_INLINE void cross_cone(const RingLights& rings,
                             int e,
                             const float* __restrict ox,
                             const float* __restrict oy,
                             const float* __restrict oz,
                             const float* __restrict dx,
                             const float* __restrict dy,
                             const float* __restrict dz,
                             ConeCrossings* __restrict crossings) {
  const RingLights* __restrict const r = &rings;
  const float c = r->tilt_cosine[e];
  const float s = r->tilt_sine[e];
  const float m = r->middle[e];
  const float half_width = 0.5F * r->width[e];
  for (int i = 0; i < kPacketSize; ++i) {
    const float fx = ox[i] - r->origin_x[e];
    const float fy = oy[i] - r->origin_y[e];
    const float fz = oz[i] - r->origin_z[e];
    const LocalRay ray = {fx * r->x_x[e] + fy * r->x_y[e] + fz * r->x_z[e],
                          fx * r->y_x[e] + fy * r->y_y[e] + fz * r->y_z[e],
                          fx * r->z_x[e] + fy * r->z_y[e] + fz * r->z_z[e],
                          dx[i] * r->x_x[e] + dy[i] * r->x_y[e] + dz[i] * r->x_z[e],
                          dx[i] * r->y_x[e] + dy[i] * r->y_y[e] + dz[i] * r->y_z[e],
                          dx[i] * r->z_x[e] + dy[i] * r->z_y[e] + dz[i] * r->z_z[e]};
    const float rise = ray.dz * c;
    const float height = ray.oz * c + m * s;
    const float a = rise * rise - s * s * (ray.dx * ray.dx + ray.dy * ray.dy);
    const float b = rise * height - s * s * (ray.ox * ray.dx + ray.oy * ray.dy);
    const float apart = height * height - s * s * (ray.ox * ray.ox + ray.oy * ray.oy);
    const float ex = rise * ray.ox - height * ray.dx;
    const float ey = rise * ray.oy - height * ray.dy;
    const float turn = s * (ray.ox * ray.dy - ray.oy * ray.dx);
    const float discriminant = ex * ex + ey * ey - turn * turn;
    const float root = std::abs(s) * std::sqrt(most(discriminant, 0.0F));
    const float q = b < 0.0F ? root - b : -(root + b);
    const ConeCrossing first =
        cone_crossing(ray, c, s, m, half_width, q / (a != 0.0F ? a : 1e-30F));
    const ConeCrossing second =
        cone_crossing(ray, c, s, m, half_width, apart / (q != 0.0F ? q : 1e-30F));
    const bool is_real = discriminant >= 0.0F;
    crossings->distance[0][i] = is_real ? first.distance : kFar_mm;
    crossings->distance[1][i] = is_real ? second.distance : kFar_mm;
    crossings->cosine[0][i] = first.cosine;
    crossings->cosine[1][i] = second.cosine;
    crossings->x[0][i] = first.x;
    crossings->x[1][i] = second.x;
    crossings->y[0][i] = first.y;
    crossings->y[1][i] = second.y;
  }
}

/// The nearer of a cone's crossings that lies in a sector.
GLINT_INLINE void cross_sector(const RingLights& rings,
                               int e,
                               const ConeCrossings* __restrict cone,
                               const float* __restrict reach,
                               RingCrossings* __restrict crossings) {
  const float first_cosine = rings.first_cosine[e];
  const float first_sine = rings.first_sine[e];
  const float span = rings.span_pseudo[e];
  const float least_cosine = rings.solid[e] > 0.0F ? -2.0F : 0.0F;
  for (int i = 0; i < kPacketSize; ++i) {
    crossings->distance[i] = kFar_mm;
    crossings->cosine[i] = 0.0F;
  }
  for (int side = 0; side < 2; ++side) {
    for (int i = 0; i < kPacketSize; ++i) {
      const float x = cone->x[side][i];
      const float y = cone->y[side][i];
      const float t = cone->distance[side][i];
      const float cosine = cone->cosine[side][i];
      const float turned =
          pseudo_angle(x * first_cosine + y * first_sine, y * first_cosine - x * first_sine);
      const bool is_before = both(t > 0.0F, t < least(reach[i], crossings->distance[i]));
      const bool is_met = both(both(is_before, turned <= span), cosine > least_cosine);
      crossings->distance[i] = is_met ? t : crossings->distance[i];
      crossings->cosine[i] = is_met ? cosine : crossings->cosine[i];
    }
  }
}

/// Flat or tilted. @param cone  of the emitter before, kept where this is another sector of it
GLINT_INLINE void cross_any(const RingLights& rings,
                            int e,
                            const float* __restrict ox,
                            const float* __restrict oy,
                            const float* __restrict oz,
                            const float* __restrict dx,
                            const float* __restrict dy,
                            const float* __restrict dz,
                            const float* __restrict reach,
                            ConeCrossings* __restrict cone,
                            RingCrossings* __restrict crossings) {
  if (rings.tilt_sine[e] == 0.0F) {
    cross_ring(rings, e, ox, oy, oz, dx, dy, dz, reach, crossings);
    return;
  }
  if (rings.same_cone[e] == 0) {
    cross_cone(rings, e, ox, oy, oz, dx, dy, dz, cone);
  }
  cross_sector(rings, e, cone, reach, crossings);
}

}  // namespace glint
