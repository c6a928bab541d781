// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where many rays meet a cross-section made of cubic pieces. A chunk of 128 neighbouring rays looks
// only at pieces whose two ends lie on different sides of at least one of its lines, and whose
// control points do not all lie behind. A crossing is found by Halley's method inside a bracket,
// starting from the chord: two steps, and three more for a ray that still moved.
// docs/theory/tunnel.md. Cost: one side test per ray and end of a piece, and mostly one piece per
// chunk. Memory: 2 kB on the stack.
#include "simulator/light/tunnel/spline_kernels.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "core/simd.h"

namespace glint {
namespace {

constexpr int kMaxSegments = 32;
/// Neighbouring rays mostly meet one segment: the others are skipped a chunk at a time.
constexpr int kChunk = 128;
constexpr float kThird = 1.0F / 3.0F;

struct Place {
  float y, z;
};

/// Where a segment begins, and the last one ends: neighbours share it to the bit, so that no line
/// slips through between them.
Place knot_at(const float* coefficients, int segment, int num_segments) {
  if (segment < num_segments) {
    return {coefficients[8 * segment], coefficients[8 * segment + 4]};
  }
  const float* c = coefficients + 8 * (num_segments - 1);
  return {c[0] + c[1] + c[2] + c[3], c[4] + c[5] + c[6] + c[7]};
}

/// One step of Halley's method for f(u) = f0 + f1 u + f2 u^2 + f3 u^3, kept in a bracket.
GLINT_INLINE void halley_step(
    float f0, float f1, float f2, float f3, float& u, float& low, float& high) {
  const float f = f0 + u * (f1 + u * (f2 + u * f3));
  const float slope = f1 + u * (2.0F * f2 + u * 3.0F * f3);
  const bool is_left = (f <= 0.0F) == (f0 <= 0.0F);
  low = is_left ? u : low;
  high = is_left ? high : u;
  const float half_bend = f2 + u * 3.0F * f3;
  const float next = u - f * slope / (slope * slope - f * half_bend);
  const bool is_inside = (next >= low) & (next <= high);
  u = is_inside ? next : 0.5F * (low + high);
}

/// The crossings of a chunk of lines with a segment; most are at rest after two steps.
struct Crossings {
  float u[kChunk];  ///< -1: none
  float low[kChunk], high[kChunk], moved[kChunk];
};

/// Steps of Halley's method on f(u), the side of the segment's points relative to a ray's line.
/// The first steps start from the chord; later ones go on where the last still moved `at_rest`.
template <int kSteps, bool kIsFirst>
GLINT_INLINE void step_crossings(const RayBlock& rays,
                                 const float* c,
                                 const Place& end,
                                 float at_rest,
                                 float* __restrict places,
                                 float* __restrict lows,
                                 float* __restrict highs,
                                 float* __restrict moves) {
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const float y0 = c[0], y1 = c[1], y2 = c[2], y3 = c[3];
  const float z0 = c[4], z1 = c[5], z2 = c[6], z3 = c[7];
  const float end_y = end.y;
  const float end_z = end.z;
  const int count = rays.count;
  for (int i = 0; i < count; ++i) {
    const float ny = dz[i];
    const float nz = -dy[i];
    const float f0 = ny * (y0 - oy[i]) + nz * (z0 - oz[i]);
    const float f1 = ny * y1 + nz * z1;
    const float f2 = ny * y2 + nz * z2;
    const float f3 = ny * y3 + nz * z3;
    const float f_end = ny * (end_y - oy[i]) + nz * (end_z - oz[i]);
    const bool crosses = (f0 <= 0.0F) != (f_end <= 0.0F);
    const float start = kIsFirst ? f0 / (f0 - f_end) : places[i];
    float u = crosses ? start : 0.5F;
    float low = kIsFirst ? 0.0F : lows[i];
    float high = kIsFirst ? 1.0F : highs[i];
    float before = u;
    for (int step = 0; step < kSteps; ++step) {
      before = u;
      halley_step(f0, f1, f2, f3, u, low, high);
    }
    const bool is_kept = !kIsFirst && !(moves[i] > at_rest);
    const float moved = u < before ? before - u : u - before;
    places[i] = is_kept ? start : (crosses ? u : -1.0F);
    lows[i] = low;
    highs[i] = high;
    moves[i] = crosses ? moved : 0.0F;
  }
}

GLINT_WIDE void find_crossings(const RayBlock& rays,
                               const float* c,
                               const Place& end,
                               Crossings& found) {
  step_crossings<2, true>(rays, c, end, 0.0F, found.u, found.low, found.high, found.moved);
}

GLINT_WIDE void finish_crossings(
    const RayBlock& rays, const float* c, const Place& end, float at_rest, Crossings& found) {
  step_crossings<3, false>(rays, c, end, at_rest, found.u, found.low, found.high, found.moved);
}

GLINT_WIDE int count_above(const float* __restrict values, int count, float limit) {
  int above = 0;
  for (int i = 0; i < count; ++i) {
    above += values[i] > limit ? 1 : 0;
  }
  return above;
}

/// Keeps the nearest crossing in front of each ray.
GLINT_WIDE void keep_nearest(const RayBlock& rays,
                             const float* c,
                             const Crossings& found,
                             float* __restrict t_mm) {
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const float y0 = c[0], y1 = c[1], y2 = c[2], y3 = c[3];
  const float z0 = c[4], z1 = c[5], z2 = c[6], z3 = c[7];
  for (int i = 0; i < rays.count; ++i) {
    const float u = found.u[i];
    const float y = y0 + u * (y1 + u * (y2 + u * y3)) - oy[i];
    const float z = z0 + u * (z1 + u * (z2 + u * z3)) - oz[i];
    const float t = (y * dy[i] + z * dz[i]) / (dy[i] * dy[i] + dz[i] * dz[i]);
    const bool is_hit = (u >= 0.0F) & (t > kNearestHit_mm) & (t < t_mm[i]);
    t_mm[i] = is_hit ? t : t_mm[i];
  }
}

/// What a ray gets does not depend on its neighbours.
void cross_segment(const RayBlock& rays, const float* coefficients, const Place& end, float* t_mm) {
  constexpr float kAtRest = 2e-3F;  // another step would change less than a float holds
  Crossings found;
  find_crossings(rays, coefficients, end, found);
  if (count_above(found.moved, rays.count, kAtRest) > 0) {
    finish_crossings(rays, coefficients, end, kAtRest, found);
  }
  keep_nearest(rays, coefficients, found, t_mm);
}

/// Rays ahead of which at least one of the segment's Bezier points lies: it is within their hull.
GLINT_WIDE int count_ahead(const RayBlock& rays, const float* c) {
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const float y0 = c[0], y1 = c[1], y2 = c[2], y3 = c[3];
  const float z0 = c[4], z1 = c[5], z2 = c[6], z3 = c[7];
  const float end_y = y0 + y1 + y2 + y3;
  const float end_z = z0 + z1 + z2 + z3;
  const float b1_y = y0 + y1 * kThird, b2_y = b1_y + (y1 + y2) * kThird;
  const float b1_z = z0 + z1 * kThird, b2_z = b1_z + (z1 + z2) * kThird;
  const int count = rays.count;
  int ahead = 0;
  for (int i = 0; i < count; ++i) {
    const float from = oy[i] * dy[i] + oz[i] * dz[i];
    const bool is_ahead = (y0 * dy[i] + z0 * dz[i] > from) | (b1_y * dy[i] + b1_z * dz[i] > from) |
                          (b2_y * dy[i] + b2_z * dz[i] > from) |
                          (end_y * dy[i] + end_z * dz[i] > from);
    ahead += is_ahead ? 1 : 0;
  }
  return ahead;
}

/// Bit s where at least one of the rays' lines has the ends of segment s on different sides: as
/// step_crossings() sees them.
GLINT_WIDE std::uint32_t find_crossed(const RayBlock& rays,
                                      const float* coefficients,
                                      int segments) {
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const int count = rays.count;
  std::int32_t is_left[kChunk] = {};
  std::uint32_t crossed = 0;
  for (int s = 0; segments > 0 && s <= segments; ++s) {
    const Place knot = knot_at(coefficients, s, segments);
    std::int32_t any = 0;
    for (int i = 0; i < count; ++i) {
      const float side = dz[i] * (knot.y - oy[i]) - dy[i] * (knot.z - oz[i]);
      const std::int32_t is_now = side <= 0.0F ? 1 : 0;
      any |= is_now ^ is_left[i];
      is_left[i] = is_now;
    }
    crossed |= s > 0 && any != 0 ? std::uint32_t{1} << (s - 1) : 0U;
  }
  return crossed;
}

void hit_spline_chunk(const RayBlock& rays,
                      const float* coefficients,
                      int num_segments,
                      float* t_mm) {
  std::fill_n(t_mm, rays.count, kNoHit_mm);
  const std::uint32_t crossed = find_crossed(rays, coefficients, num_segments);
  for (std::uint32_t left = crossed; left != 0; left &= left - 1) {
    const int segment = std::countr_zero(left);
    const float* c = coefficients + 8 * segment;
    if (count_ahead(rays, c) > 0) {
      cross_segment(rays, c, knot_at(coefficients, segment + 1, num_segments), t_mm);
    }
  }
}

}  // namespace

void hit_spline(const RayBlock& rays,
                const SplineSegment* segments,
                int num_segments,
                float* t_mm) {
  float coefficients[8 * kMaxSegments];
  const int used = num_segments < kMaxSegments ? num_segments : kMaxSegments;
  for (int s = 0; s < used; ++s) {
    for (int k = 0; k < 4; ++k) {
      coefficients[8 * s + k] = static_cast<float>(segments[s].y[k]);
      coefficients[8 * s + 4 + k] = static_cast<float>(segments[s].z[k]);
    }
  }
  for (int begin = 0; begin < rays.count; begin += kChunk) {
    const int count = rays.count - begin < kChunk ? rays.count - begin : kChunk;
    const RayBlock chunk = {.origin_x = rays.origin_x + begin,
                            .origin_y = rays.origin_y + begin,
                            .origin_z = rays.origin_z + begin,
                            .direction_x = rays.direction_x + begin,
                            .direction_y = rays.direction_y + begin,
                            .direction_z = rays.direction_z + begin,
                            .count = count};
    hit_spline_chunk(chunk, coefficients, used, t_mm + begin);
  }
}

}  // namespace glint
