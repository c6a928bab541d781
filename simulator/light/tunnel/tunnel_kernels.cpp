// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where many rays meet the tunnel's wall, and the stripes they see there, in float. The tunnel is
// extruded along x, so this is a problem of lines in the y-z plane: straight panels, a quadratic
// equation for the ellipse, and for the superellipse two steps of Halley's method from an octagon
// around it, on the norm, which is almost linear along a ray (own derivation).
// docs/theory/tunnel.md, "What a candidate costs". Cost: some twenty operations per ray, four
// powers more for a superellipse; loops without branches, no memory. tunnel_profile.h has the same
// in double by bisection, for the tests.
#include "simulator/light/tunnel/tunnel_kernels.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/simd.h"
#include "simulator/light/tunnel/cos_turns.h"

namespace glint {
namespace {

/// 2-logarithm of x > 0 to 2e-7, by the exponent and a series in (m - 1) / (m + 1).
GLINT_INLINE float log2_fast(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t shifted = bits - 0x3F3504F3;  // mantissa in [sqrt(1/2), sqrt(2))
  const std::int32_t exponent = shifted >> 23;
  const auto mantissa = std::bit_cast<float>(bits - (exponent << 23));
  const float s = (mantissa - 1.0F) / (mantissa + 1.0F);
  const float s2 = s * s;
  const float series =
      s * (2.0F + s2 * (0.66666667F + s2 * (0.4F + s2 * (0.28571429F + s2 * 0.22222222F))));
  return static_cast<float>(exponent) + series * 1.44269504F;
}

/// The same to 3e-4.
GLINT_INLINE float log2_rough(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t shifted = bits - 0x3F3504F3;
  const std::int32_t exponent = shifted >> 23;
  const float f = std::bit_cast<float>(bits - (exponent << 23)) - 1.0F;
  const float series = f * (1.4423071F + f * (-0.7246998F + f * (0.5101832F + f * -0.3226236F)));
  return static_cast<float>(exponent) + series;
}

/// 2^x to 2e-7 for |x| < 126.
GLINT_INLINE float exp2_fast(float x) {
  const float clamped = x < -125.0F ? -125.0F : (x > 125.0F ? 125.0F : x);
  const float whole = std::floor(clamped + 0.5F);
  const float f = (clamped - whole) * 0.69314718F;
  const float series =
      1.0F +
      f * (1.0F + f * (0.5F + f * (0.16666667F +
                                   f * (0.041666667F + f * (0.0083333333F + f * 0.0013888889F)))));
  const auto power = std::bit_cast<float>((static_cast<std::int32_t>(whole) + 127) << 23);
  return series * power;
}

/// The same to 1e-4.
GLINT_INLINE float exp2_rough(float x) {
  const float clamped = x < -125.0F ? -125.0F : (x > 125.0F ? 125.0F : x);
  const float whole = std::floor(clamped + 0.5F);
  const float f = clamped - whole;
  const float series = 0.9999246F + f * (0.6931367F + f * (0.2426395F + f * 0.0558383F));
  const auto power = std::bit_cast<float>((static_cast<std::int32_t>(whole) + 127) << 23);
  return series * power;
}

/// x^exponent for x > 0; rough: as good as a first guess needs.
template <bool kIsRough>
GLINT_INLINE float pow_fast(float x, float exponent) {
  return kIsRough ? exp2_rough(exponent * log2_rough(x)) : exp2_fast(exponent * log2_fast(x));
}

}  // namespace

GLINT_WIDE void hit_flat(const RayBlock& rays,
                         const FlatWall* walls,
                         int num_walls,
                         bool is_whole,
                         float* __restrict t_mm) {
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const int count = rays.count;
  for (int i = 0; i < count; ++i) {
    t_mm[i] = kNoHit_mm;
  }
  for (int w = 0; w < num_walls; ++w) {
    const auto ny = static_cast<float>(walls[w].normal_y);
    const auto nz = static_cast<float>(walls[w].normal_z);
    const auto offset = static_cast<float>(walls[w].offset_mm);
    const auto sy = static_cast<float>(walls[w].start_y_mm);
    const auto sz = static_cast<float>(walls[w].start_z_mm);
    const auto ay = static_cast<float>(walls[w].along_y);
    const auto az = static_cast<float>(walls[w].along_z);
    const float minimum = is_whole ? -kNoHit_mm : 0.0F;
    const float maximum = is_whole ? kNoHit_mm : static_cast<float>(walls[w].length_mm);
    for (int i = 0; i < count; ++i) {
      const float slope = ny * dy[i] + nz * dz[i];
      const float t = (offset - ny * oy[i] - nz * oz[i]) / slope;
      const float s = (oy[i] + t * dy[i] - sy) * ay + (oz[i] + t * dz[i] - sz) * az;
      // Bitwise: short-circuit tests would keep the loop from being vectorised.
      const bool is_hit =
          (slope > 0.0F) & (t > kNearestHit_mm) & (t < t_mm[i]) & (s >= minimum) & (s <= maximum);
      t_mm[i] = is_hit ? t : t_mm[i];
    }
  }
}

GLINT_WIDE void margins_of_panels(const FlatWall& right,
                                  bool touch_at_top,
                                  const float* __restrict y_mm,
                                  int count,
                                  float* __restrict z_mm) {
  const auto foot_y = static_cast<float>(right.start_y_mm);
  const auto foot_z = static_cast<float>(right.start_z_mm);
  const auto along_y = static_cast<float>(right.along_y);
  const auto along_z = static_cast<float>(right.along_z);
  const float length = touch_at_top ? kNoHit_mm : static_cast<float>(right.length_mm);
  for (int i = 0; i < count; ++i) {
    const float y = y_mm[i] < 0.0F ? -y_mm[i] : y_mm[i];
    const float s = (y - foot_y) * along_y + (z_mm[i] - foot_z) * along_z;
    const float to_end = length - s;
    const float margin = s < to_end ? s : to_end;
    z_mm[i] = z_mm[i] > kNoHitMargin_mm ? margin : kNoHitMargin_mm;
  }
}

GLINT_WIDE void hit_ellipse(const RayBlock& rays,
                            float base_mm,
                            float half_width_mm,
                            float height_mm,
                            bool is_whole,
                            float* __restrict t_mm) {
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const float per_width = 1.0F / half_width_mm;
  const float per_height = 1.0F / height_mm;
  const float lowest = is_whole ? -2.0F : 0.0F;
  for (int i = 0; i < rays.count; ++i) {
    const float py = oy[i] * per_width;
    const float pz = (oz[i] - base_mm) * per_height;
    const float vy = dy[i] * per_width;
    const float vz = dz[i] * per_height;
    const float a = vy * vy + vz * vz;
    const float b = py * vy + pz * vz;
    const float c = py * py + pz * pz - 1.0F;
    const float discriminant = b * b - a * c;
    const float t = (std::sqrt(discriminant > 0.0F ? discriminant : 0.0F) - b) / a;
    const bool is_hit =
        (discriminant > 0.0F) & (a > 0.0F) & (t > kNearestHit_mm) & (pz + t * vz >= lowest);
    t_mm[i] = is_hit ? t : kNoHit_mm;
  }
}

namespace {

/// A superellipse of half axes 1 around (0, 0): rays are scaled to it.
struct Superellipse {
  float base_mm = 0.0F;
  float per_width = 1.0F;
  float per_height = 1.0F;
  float exponent = 2.0F;
  float diagonal = 1.0F;  ///< |y| + |z| at its diagonal points

  Superellipse(float base, float half_width_mm, float height_mm, float power)
      : base_mm(base),
        per_width(1.0F / half_width_mm),
        per_height(1.0F / height_mm),
        exponent(power),
        diagonal(std::exp2(1.0F - 1.0F / power)) {}
};

/// The curve lies within the square |y|, |z| <= 1 of its half axes and within the tangents of its
/// diagonal points, |y| + |z| <= diagonal. A ray's exit from the octagon is outside the curve by a
/// few hundredths.
GLINT_INLINE float superellipse_start(float y, float z, float vy, float vz, float diagonal) {
  // Mirrored so that the ray runs towards positive y and z.
  const float speed_y = vy < 0.0F ? -vy : vy;
  const float speed_z = vz < 0.0F ? -vz : vz;
  const float from_y = vy < 0.0F ? -y : y;
  const float from_z = vz < 0.0F ? -z : z;
  const float to_y = (1.0F - from_y) / (speed_y > 1e-12F ? speed_y : 1e-12F);
  const float to_z = (1.0F - from_z) / (speed_z > 1e-12F ? speed_z : 1e-12F);
  const float speed = speed_y + speed_z;
  const float to_corner = (diagonal - from_y - from_z) / (speed > 1e-12F ? speed : 1e-12F);
  const float to_side = to_y < to_z ? to_y : to_z;
  return to_corner < to_side ? to_corner : to_side;
}

/// One step of Halley's method on the norm N = s^(1/n) - 1 with s = |y|^n + |z|^n, which is almost
/// straight along a ray: two steps come nearer than three of Newton's on s. With s = 1 + e, slope
/// and bend of s, p = 1 - 1/n and q = n s^p N = e + p e^2 / 2 - ... the step is
/// q slope s / (slope^2 s - q (bend s - p slope^2) / 2).
template <bool kIsRough>
GLINT_INLINE float superellipse_step(float t, float y0, float z0, float vy, float vz, float n) {
  constexpr float kSmallest = 1e-12F;
  constexpr float kMaxBent = 0.75F;  // far off, where the curve bends within a step
  const float y = y0 + t * vy;
  const float z = z0 + t * vz;
  const float size_y = y < 0.0F ? -y : y;
  const float size_z = z < 0.0F ? -z : z;
  const float ay = size_y > kSmallest ? size_y : kSmallest;
  const float az = size_z > kSmallest ? size_z : kSmallest;
  const float hy = pow_fast<kIsRough>(ay, n - 2.0F);
  const float hz = pow_fast<kIsRough>(az, n - 2.0F);
  const float gy = hy * ay;
  const float gz = hz * az;
  const float s = ay * gy + az * gz;
  const float e = s - 1.0F;
  const float by = y < 0.0F ? -vy : vy;
  const float bz = z < 0.0F ? -vz : vz;
  const float slope = n * (gy * by + gz * bz);
  const float bend = n * (n - 1.0F) * (hy * vy * vy + hz * vz * vz);
  const float p = 1.0F - 1.0F / n;
  const float q = e * (1.0F + e * (0.5F * p) * (1.0F - e * ((2.0F - p) / 3.0F)));
  const float squared = slope * slope;
  const float straight = squared * s;
  const float maximum = kMaxBent * straight;
  const float bent = 0.5F * q * (bend * s - p * squared);
  const float kept = bent > maximum ? maximum : (bent < -maximum ? -maximum : bent);
  return slope > kSmallest ? t - q * slope * s / (straight - kept) : t;
}

/// Steps are the outer loops: the long chain of one step is enough to wait for.
GLINT_WIDE void start_at_octagon(const RayBlock& rays,
                                 const Superellipse& curve,
                                 float* __restrict t_mm) {
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const Superellipse s = curve;
  const int count = rays.count;
  for (int i = 0; i < count; ++i) {
    t_mm[i] = superellipse_start(oy[i] * s.per_width,
                                 (oz[i] - s.base_mm) * s.per_height,
                                 dy[i] * s.per_width,
                                 dz[i] * s.per_height,
                                 s.diagonal);
  }
}

template <bool kIsRough>
GLINT_INLINE void step(const RayBlock& rays, const Superellipse& curve, float* __restrict t_mm) {
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const Superellipse s = curve;
  const int count = rays.count;
  for (int i = 0; i < count; ++i) {
    t_mm[i] = superellipse_step<kIsRough>(t_mm[i],
                                          oy[i] * s.per_width,
                                          (oz[i] - s.base_mm) * s.per_height,
                                          dy[i] * s.per_width,
                                          dz[i] * s.per_height,
                                          s.exponent);
  }
}

/// The first step errs by more than the powers in it do.
GLINT_WIDE void step_near_curve(const RayBlock& rays,
                                const Superellipse& curve,
                                float* __restrict t_mm) {
  step<true>(rays, curve, t_mm);
}

GLINT_WIDE void step_to_curve(const RayBlock& rays,
                              const Superellipse& curve,
                              float* __restrict t_mm) {
  step<false>(rays, curve, t_mm);
}

GLINT_WIDE void check_curve(const RayBlock& rays, float lowest_mm, float* __restrict t_mm) {
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const int count = rays.count;
  for (int i = 0; i < count; ++i) {
    const float t = t_mm[i];
    const bool is_hit = (dy[i] * dy[i] + dz[i] * dz[i] > 0.0F) & (t > kNearestHit_mm) & (t < 1e6F) &
                        (oz[i] + t * dz[i] >= lowest_mm);
    t_mm[i] = is_hit ? t : kNoHit_mm;
  }
}

}  // namespace

void hit_superellipse(const RayBlock& rays,
                      float base_mm,
                      float half_width_mm,
                      float height_mm,
                      float exponent,
                      bool is_whole,
                      float* t_mm) {
  const Superellipse curve(base_mm, half_width_mm, height_mm, exponent);
  start_at_octagon(rays, curve, t_mm);
  step_near_curve(rays, curve, t_mm);
  step_to_curve(rays, curve, t_mm);
  check_curve(rays, is_whole ? base_mm - 2.0F * height_mm : base_mm, t_mm);
}

GLINT_WIDE void aim_at(const RayBlock& points,
                       float x_mm,
                       float y_mm,
                       float z_mm,
                       float* __restrict to_x,
                       float* __restrict to_y,
                       float* __restrict to_z) {
  const float* __restrict ox = points.origin_x;
  const float* __restrict oy = points.origin_y;
  const float* __restrict oz = points.origin_z;
  const int count = points.count;
  for (int i = 0; i < count; ++i) {
    to_x[i] = x_mm - ox[i];
    to_y[i] = y_mm - oy[i];
    to_z[i] = z_mm - oz[i];
  }
}

GLINT_WIDE void keep_sight(const float* __restrict t,
                           const float* __restrict x_mm,
                           int count,
                           float half_length_mm,
                           float* __restrict occluded) {
  for (int i = 0; i < count; ++i) {
    const float size = x_mm[i] < 0.0F ? -x_mm[i] : x_mm[i];
    occluded[i] = ((t[i] < 1.0F) & (size < half_length_mm)) ? occluded[i] : 0.0F;
  }
}

GLINT_WIDE void finish_hits(const RayBlock& rays,
                            const float* __restrict t_mm,
                            float half_slot_mm,
                            float slot_floor_mm,
                            float* __restrict x_mm,
                            float* __restrict gain) {
  const float* __restrict ox = rays.origin_x;
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dx = rays.direction_x;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  for (int i = 0; i < rays.count; ++i) {
    const bool is_hit = t_mm[i] < kNoHit_mm;
    const float t = is_hit ? t_mm[i] : 0.0F;
    const float y = oy[i] + t * dy[i];
    const float z = oz[i] + t * dz[i];
    const bool in_slot = (y < half_slot_mm) & (y > -half_slot_mm) & (z > slot_floor_mm);
    x_mm[i] = ox[i] + t * dx[i];
    gain[i] = (is_hit & !in_slot) ? 1.0F : 0.0F;
  }
}

GLINT_WIDE void points_of_hits(const RayBlock& rays,
                               const float* __restrict t_mm,
                               float base_mm,
                               float* __restrict x_mm,
                               float* __restrict y_mm,
                               float* __restrict above_base_mm) {
  const float* __restrict ox = rays.origin_x;
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dx = rays.direction_x;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  for (int i = 0; i < rays.count; ++i) {
    const bool is_hit = t_mm[i] < kNoHit_mm;
    const float t = is_hit ? t_mm[i] : 0.0F;
    x_mm[i] = ox[i] + t * dx[i];
    y_mm[i] = oy[i] + t * dy[i];
    above_base_mm[i] = is_hit ? oz[i] + t * dz[i] - base_mm : kNoHitMargin_mm;
  }
}

GLINT_WIDE static void add_plain_stripes(const float* __restrict x_mm,
                                         const float* __restrict q_mm,
                                         const float* __restrict gain,
                                         int count,
                                         const StripePattern& pattern,
                                         float scale,
                                         float* __restrict out) {
  const StripePattern p = pattern;
  const float bright = scale;
  const float dark = scale * p.dark;
  for (int i = 0; i < count; ++i) {
    const float u = x_mm[i] - p.shift_x_mm;
    const float v = (q_mm[i] - p.shift_pattern_mm) * p.periods_per_mm;
    const float f = v - std::floor(v);
    const float stripe = f < p.duty ? bright : dark;
    const bool is_lit = (u < p.half_length_mm) & (u > -p.half_length_mm);
    out[i] += is_lit ? gain[i] * stripe : 0.0F;
  }
}

GLINT_WIDE static void add_uneven_stripes(const float* __restrict x_mm,
                                          const float* __restrict q_mm,
                                          const float* __restrict gain,
                                          int count,
                                          const StripePattern& pattern,
                                          float scale,
                                          float* __restrict out) {
  const StripePattern p = pattern;
  const float per_half_length = 1.0F / p.half_length_mm;
  for (int i = 0; i < count; ++i) {
    const float u = x_mm[i] - p.shift_x_mm;
    const float v = (q_mm[i] - p.shift_pattern_mm) * p.periods_per_mm;
    const float f = v - std::floor(v);
    const float stripe = f < p.duty ? scale : scale * p.dark;
    const float end = u * per_half_length;
    const float led = (1.0F + p.led_ripple * cos_turns(u * p.led_per_mm)) / (1.0F + p.led_ripple) *
                      (1.0F - p.end_falloff * end * end);
    const bool is_lit = (end < 1.0F) & (end > -1.0F);
    out[i] += is_lit ? gain[i] * stripe * led : 0.0F;
  }
}

void add_stripes(const float* x_mm,
                 const float* q_mm,
                 const float* gain,
                 int count,
                 const StripePattern& pattern,
                 float scale,
                 float* out) {
  if (pattern.led_ripple == 0.0F && pattern.end_falloff == 0.0F) {
    add_plain_stripes(x_mm, q_mm, gain, count, pattern, scale, out);
  } else {
    add_uneven_stripes(x_mm, q_mm, gain, count, pattern, scale, out);
  }
}

}  // namespace glint
