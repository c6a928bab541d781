// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/tunnel_kernels.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "simulator/light/cos_turns.h"

#define GLINT_WIDE __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))

namespace glint {
namespace {

/// 2-logarithm of x > 0 to 2e-7, by the exponent and a series in (m - 1) / (m + 1).
__attribute__((always_inline)) inline float log2_fast(float x) {
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

/// 2^x to 2e-7 for |x| < 126.
__attribute__((always_inline)) inline float exp2_fast(float x) {
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

__attribute__((always_inline)) inline float pow_fast(float x, float exponent) {
  return exp2_fast(exponent * log2_fast(x > 1e-12F ? x : 1e-12F));
}

}  // namespace

GLINT_WIDE void hit_flat(const RayBlock& rays,
                         const FlatWall* walls,
                         int num_walls,
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
    const auto length = static_cast<float>(walls[w].length_mm);
    for (int i = 0; i < count; ++i) {
      const float slope = ny * dy[i] + nz * dz[i];
      const float t = (offset - ny * oy[i] - nz * oz[i]) / slope;
      const float s = (oy[i] + t * dy[i] - sy) * ay + (oz[i] + t * dz[i] - sz) * az;
      // Bitwise: short-circuit tests would keep the loop from being vectorised.
      const bool is_hit =
          (slope > 0.0F) & (t > kNearestHit_mm) & (t < t_mm[i]) & (s >= 0.0F) & (s <= length);
      t_mm[i] = is_hit ? t : t_mm[i];
    }
  }
}

GLINT_WIDE void hit_flat_lines(const RayBlock& rays,
                               const FlatWall* walls,
                               bool meets_at_top,
                               float* __restrict t_mm,
                               float* __restrict margin_mm) {
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const int count = rays.count;
  for (int i = 0; i < count; ++i) {
    t_mm[i] = kNoHit_mm;
  }
  for (int w = 0; w < 2; ++w) {
    const auto ny = static_cast<float>(walls[w].normal_y);
    const auto nz = static_cast<float>(walls[w].normal_z);
    const auto offset = static_cast<float>(walls[w].offset_mm);
    for (int i = 0; i < count; ++i) {
      const float slope = ny * dy[i] + nz * dz[i];
      const float t = (offset - ny * oy[i] - nz * oz[i]) / slope;
      const bool is_hit = (slope > 0.0F) & (t > kNearestHit_mm) & (t < t_mm[i]);
      t_mm[i] = is_hit ? t : t_mm[i];
    }
  }
  // The walls mirror each other in y = 0, which they do not cross.
  const auto foot_y = static_cast<float>(walls[1].start_y_mm);
  const auto foot_z = static_cast<float>(walls[1].start_z_mm);
  const auto along_y = static_cast<float>(walls[1].along_y);
  const auto along_z = static_cast<float>(walls[1].along_z);
  const auto length = meets_at_top ? 1e30F : static_cast<float>(walls[1].length_mm);
  for (int i = 0; i < count; ++i) {
    const bool is_hit = t_mm[i] < kNoHit_mm;
    const float t = is_hit ? t_mm[i] : 0.0F;
    const float y = oy[i] + t * dy[i];
    const float beside = y < 0.0F ? -y : y;
    const float s = (beside - foot_y) * along_y + (oz[i] + t * dz[i] - foot_z) * along_z;
    const float to_end = length - s;
    const float margin = s < to_end ? s : to_end;
    margin_mm[i] = is_hit ? margin : kNowhere_mm;
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

/// hit_ellipse() and points_of_hits() in one sweep.
GLINT_WIDE void meet_ellipse(const RayBlock& rays,
                             float base_mm,
                             float half_width_mm,
                             float height_mm,
                             float* __restrict x_mm,
                             float* __restrict y_mm,
                             float* __restrict above_base_mm) {
  const float* __restrict ox = rays.origin_x;
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dx = rays.direction_x;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const float per_width = 1.0F / half_width_mm;
  const float per_height = 1.0F / height_mm;
  const int count = rays.count;
  for (int i = 0; i < count; ++i) {
    const float py = oy[i] * per_width;
    const float pz = (oz[i] - base_mm) * per_height;
    const float vy = dy[i] * per_width;
    const float vz = dz[i] * per_height;
    const float a = vy * vy + vz * vz;
    const float b = py * vy + pz * vz;
    const float c = py * py + pz * pz - 1.0F;
    const float discriminant = b * b - a * c;
    const float root = (std::sqrt(discriminant > 0.0F ? discriminant : 0.0F) - b) / a;
    const bool is_hit =
        (discriminant > 0.0F) & (a > 0.0F) & (root > kNearestHit_mm) & (pz + root * vz >= -2.0F);
    const float t = is_hit ? root : 0.0F;
    x_mm[i] = ox[i] + t * dx[i];
    y_mm[i] = oy[i] + t * dy[i];
    above_base_mm[i] = is_hit ? oz[i] + t * dz[i] - base_mm : kNowhere_mm;
  }
}

/// One step of Newton's method for every ray. Steps are the outer loop so that rays vectorise.
GLINT_WIDE static void superellipse_step(const RayBlock& rays,
                                         float base_mm,
                                         float per_width,
                                         float per_height,
                                         float exponent,
                                         float* __restrict t_mm) {
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  for (int i = 0; i < rays.count; ++i) {
    const float vy = dy[i] * per_width;
    const float vz = dz[i] * per_height;
    const float y = oy[i] * per_width + t_mm[i] * vy;
    const float z = (oz[i] - base_mm) * per_height + t_mm[i] * vz;
    const float ay = y < 0.0F ? -y : y;
    const float az = z < 0.0F ? -z : z;
    const float gy = pow_fast(ay, exponent - 1.0F);
    const float gz = pow_fast(az, exponent - 1.0F);
    const float value = ay * gy + az * gz - 1.0F;
    const float slope = exponent * (gy * (y < 0.0F ? -vy : vy) + gz * (z < 0.0F ? -vz : vz));
    t_mm[i] = slope > 1e-12F ? t_mm[i] - value / slope : t_mm[i];
  }
}

/// The curve lies within the square |y|, |z| <= 1 of its half axes and within the tangents of its
/// diagonal points, |y| + |z| <= diagonal. A ray's exit from the octagon is outside the curve by a
/// few hundredths; from there Newton's method on the convex function falls onto the curve.
GLINT_WIDE static void superellipse_start(const RayBlock& rays,
                                          float base_mm,
                                          float per_width,
                                          float per_height,
                                          float diagonal,
                                          float* __restrict t_mm) {
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  for (int i = 0; i < rays.count; ++i) {
    // Mirrored so that the ray runs towards positive y and z.
    const float speed_y = dy[i] < 0.0F ? -dy[i] * per_width : dy[i] * per_width;
    const float speed_z = dz[i] < 0.0F ? -dz[i] * per_height : dz[i] * per_height;
    const float y = dy[i] < 0.0F ? -oy[i] * per_width : oy[i] * per_width;
    const float height = (oz[i] - base_mm) * per_height;
    const float z = dz[i] < 0.0F ? -height : height;
    const float to_y = (1.0F - y) / (speed_y > 1e-12F ? speed_y : 1e-12F);
    const float to_z = (1.0F - z) / (speed_z > 1e-12F ? speed_z : 1e-12F);
    const float speed = speed_y + speed_z;
    const float to_corner = (diagonal - y - z) / (speed > 1e-12F ? speed : 1e-12F);
    const float to_side = to_y < to_z ? to_y : to_z;
    t_mm[i] = to_corner < to_side ? to_corner : to_side;
  }
}

GLINT_WIDE static void superellipse_check(const RayBlock& rays,
                                          float base_mm,
                                          float* __restrict t_mm) {
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  for (int i = 0; i < rays.count; ++i) {
    const float t = t_mm[i];
    const bool is_hit = (dy[i] * dy[i] + dz[i] * dz[i] > 0.0F) & (t > kNearestHit_mm) & (t < 1e6F) &
                        (oz[i] + t * dz[i] >= base_mm);
    t_mm[i] = is_hit ? t : kNoHit_mm;
  }
}

void hit_superellipse(const RayBlock& rays,
                      float base_mm,
                      float half_width_mm,
                      float height_mm,
                      float exponent,
                      bool is_whole,
                      float* t_mm) {
  constexpr int kSteps = 3;
  const float per_width = 1.0F / half_width_mm;
  const float per_height = 1.0F / height_mm;
  const float diagonal = std::exp2(1.0F - 1.0F / exponent);
  superellipse_start(rays, base_mm, per_width, per_height, diagonal, t_mm);
  for (int step = 0; step < kSteps; ++step) {
    superellipse_step(rays, base_mm, per_width, per_height, exponent, t_mm);
  }
  superellipse_check(rays, is_whole ? base_mm - 2.0F * height_mm : base_mm, t_mm);
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
    above_base_mm[i] = is_hit ? oz[i] + t * dz[i] - base_mm : kNowhere_mm;
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

GLINT_WIDE void shift_slopes(const RayBlock& rays,
                             const float* __restrict y_mm,
                             const float* __restrict margin_mm,
                             const HitSlopes& slopes,
                             const WallNormals& normals,
                             float* __restrict place,
                             float* __restrict by_shift) {
  const float* __restrict dx = rays.direction_x;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  const float* __restrict by_x = slopes.x;
  const float* __restrict by_y = slopes.y;
  const float* __restrict by_margin = slopes.margin;
  const float* __restrict normal_y = normals.y;
  const float* __restrict normal_z = normals.z;
  const int pieces = normals.pieces;
  const int count = rays.count;
  for (int i = 0; i < count; ++i) {
    const float beside = y_mm[i] < 0.0F ? -y_mm[i] : y_mm[i];
    const float size = beside + (margin_mm[i] > 0.0F ? margin_mm[i] : 0.0F);
    const float angle = y_mm[i] / (size > 1e-9F ? size : 1e-9F);
    const float at = 0.5F * (angle + 1.0F) * static_cast<float>(pieces);
    const int whole = static_cast<int>(at);
    const int node = whole < pieces ? whole : pieces - 1;
    const float part = at - static_cast<float>(node);
    const float ny = normal_y[node] + part * (normal_y[node + 1] - normal_y[node]);
    const float nz = normal_z[node] + part * (normal_z[node + 1] - normal_z[node]);
    const float along_ray = by_x[i] * dx[i] + by_y[i] * dy[i] + by_margin[i] * dz[i];
    const float through = ny * dy[i] + nz * dz[i];
    const bool has_slope = (by_x[i] != 0.0F) | (by_y[i] != 0.0F) | (by_margin[i] != 0.0F);
    place[i] = at;
    by_shift[i] = has_slope ? along_ray / through : 0.0F;
  }
}

}  // namespace glint
