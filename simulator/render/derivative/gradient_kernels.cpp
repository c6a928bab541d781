// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives of the trapezoid of footprint_kernels.cpp by the phase, by both phase differences and
// by the duty, weighted and summed over frames; and small loops over rows that the reverse mode
// needs. A phase is a 32-bit fraction of a period: whole periods wrap and differences are exact,
// where floats would lose the digits by which the two edges of a stripe differ.
// docs/theory/derivatives.md, "Digits". Cost: three edges per pixel and frame, one where footprints
// are narrow; without branches and memory.
#include "simulator/render/derivative/gradient_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/simd.h"
#include "simulator/render/footprint/footprint_kernels.h"
#include "simulator/render/footprint/footprint_lane.h"

namespace glint::gradient_kernels {
namespace {

using footprint_lane::absolute;
using footprint_lane::Widths;
using footprint_lane::widths_of;

constexpr std::size_t kDoubleLanes = 8;

/// Half turns, so that differences of two in [0, 1] fit a signed number.
constexpr float kPerHalfTurn = 1.0F / 2147483648.0F;
constexpr float kPerTurn = 1.0F / 4294967296.0F;

std::int32_t half_turns_of(double periods) {
  constexpr double kMax = 2147483647.0;
  return static_cast<std::int32_t>(std::clamp(periods * 2147483648.0, 0.0, kMax));
}

/// The share beyond an edge of the stripes, less one half, and its derivatives.
struct EdgeShare {
  float share;
  float by_distance, by_major, by_minor;  ///< the first two times the larger width
};

/// @param distance  from the footprint's middle, without sign
GLINT_INLINE EdgeShare share_beyond(float distance,
                                    const Widths& widths,
                                    float per_major,
                                    float per_minor) {
  const float outer = widths.outer();
  const float inner = widths.inner();
  const float is_near = distance < outer ? 1.0F : 0.0F;
  const float t = distance < outer ? distance : outer;
  const float over = (t > inner ? t - inner : 0.0F) * per_minor;
  const float half = 0.5F * over * over * widths.minor * per_major;
  return {.share = t * per_major - half,
          .by_distance = is_near * (1.0F - over),
          .by_major = is_near * (half - t * per_major + 0.5F * over),
          .by_minor = is_near * (per_minor * half - 0.5F * over * per_major)};
}

}  // namespace

/// Restricted pointers must be parameters: the compiler believes them only there.
GLINT_WIDE static void add_box_derivatives(const FixedPhase* __restrict v,
                                           const float* __restrict gx,
                                           const float* __restrict gy,
                                           const float* __restrict weight,
                                           int count,
                                           FixedPhase shift,
                                           std::int32_t duty,
                                           float* __restrict by_v,
                                           float* __restrict by_gx,
                                           float* __restrict by_gy,
                                           float* __restrict by_duty,
                                           float* __restrict dark) {
  for (int i = 0; i < count; ++i) {
    const Widths widths = widths_of(gx[i], gy[i]);
    const float per_major = 1.0F / widths.major;
    const float per_minor = 1.0F / widths.minor;
    const FixedPhase moved = v[i] - shift;
    const auto half_turns = static_cast<std::int32_t>(moved >> 1U);
    const auto to_next = static_cast<std::int32_t>(~moved >> 1U);
    const float to_rise = kPerHalfTurn * static_cast<float>(half_turns);
    const float to_fall = kPerHalfTurn * static_cast<float>(half_turns - duty);
    // The next rising edge, seen from its other side.
    const float from_next = kPerHalfTurn * static_cast<float>(to_next);
    const EdgeShare rise = share_beyond(to_rise, widths, per_major, per_minor);
    const EdgeShare fall = share_beyond(absolute(to_fall), widths, per_major, per_minor);
    const EdgeShare next = share_beyond(from_next, widths, per_major, per_minor);
    const float fall_sign = to_fall < 0.0F ? -1.0F : 1.0F;
    const float by_major = per_major * (rise.by_major - fall_sign * fall.by_major - next.by_major);
    const float by_minor = rise.by_minor - fall_sign * fall.by_minor - next.by_minor;
    const float bright = 0.5F + rise.share - fall_sign * fall.share - next.share;
    const float x_sign = gx[i] < 0.0F ? -1.0F : 1.0F;
    const float y_sign = gy[i] < 0.0F ? -1.0F : 1.0F;
    const bool is_y_larger = absolute(gx[i]) < absolute(gy[i]);
    const float by_x = is_y_larger ? by_minor : by_major;
    const float by_y = is_y_larger ? by_major : by_minor;
    by_v[i] += weight[i] * per_major * (rise.by_distance - fall.by_distance + next.by_distance);
    by_gx[i] += weight[i] * x_sign * by_x;
    by_gy[i] += weight[i] * y_sign * by_y;
    by_duty[i] += weight[i] * per_major * fall.by_distance;
    dark[i] += weight[i] * (1.0F - bright);
  }
}

namespace {

GLINT_WIDE void add_gradients(const float* __restrict by_gx,
                              const float* __restrict by_gy,
                              int corners,
                              float* __restrict top,
                              float* __restrict bottom) {
  for (int i = 0; i < corners; ++i) {
    const float across = 0.5F * (by_gx[i - 1] - by_gx[i]);
    const float down = 0.5F * (by_gy[i - 1] + by_gy[i]);
    top[i] += across - down;
    bottom[i] += across + down;
  }
}

GLINT_WIDE void add_means(const float* __restrict by_v,
                          int corners,
                          float* __restrict top,
                          float* __restrict bottom) {
  for (int i = 0; i < corners; ++i) {
    const float mean = 0.25F * (by_v[i - 1] + by_v[i]);
    top[i] += mean;
    bottom[i] += mean;
  }
}

}  // namespace

void add_gradients_to_corners(
    const float* by_gx, const float* by_gy, int count, float* top, float* bottom) {
  add_gradients(by_gx, by_gy, count + 1, top, bottom);
}

void add_means_to_corners(const float* by_v, int count, float* top, float* bottom) {
  add_means(by_v, count + 1, top, bottom);
}

void add_box_gradients(const FixedPhase* v,
                       const float* gx,
                       const float* gy,
                       const float* weight,
                       int count,
                       double shift,
                       double duty,
                       const BoxGradients& out) {
  add_box_derivatives(v,
                      gx,
                      gy,
                      weight,
                      count,
                      fixed_phase_of(shift),
                      half_turns_of(duty),
                      out.v,
                      out.gx,
                      out.gy,
                      out.duty,
                      out.dark);
}

namespace {

using Eight = double __attribute__((vector_size(kDoubleLanes * sizeof(double))));

GLINT_INLINE double total_of(const float* values, int count) {
  using Floats = float __attribute__((vector_size(kDoubleLanes * sizeof(float))));
  Eight lanes = {};
  for (int i = 0; i < count; i += static_cast<int>(kDoubleLanes)) {
    Floats some;
    std::memcpy(&some, values + i, sizeof(some));
    lanes += __builtin_convertvector(some, Eight);
  }
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) +
         ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

}  // namespace

GLINT_WIDE BoxSums totals_of(const BoxGradients& gradient, int count) {
  return {.v = total_of(gradient.v, count),
          .gx = total_of(gradient.gx, count),
          .gy = total_of(gradient.gy, count),
          .duty = total_of(gradient.duty, count),
          .dark = total_of(gradient.dark, count)};
}

GLINT_WIDE static void find_phases(const float* __restrict top,
                                   const float* __restrict bottom,
                                   int count,
                                   double offset_mm,
                                   double per_period,
                                   double* __restrict phases,
                                   FixedPhase* __restrict v,
                                   float* __restrict gx,
                                   float* __restrict gy) {
  // The last digit of a double of this size is a turn's: its lower half is the phase.
  constexpr double kTurnsAreLast = 1572864.0;  // 1.5 * 2^20
  for (int i = 0; i < count; ++i) {
    const auto a = static_cast<double>(top[i]);
    const auto b = static_cast<double>(top[i + 1]);
    const auto c = static_cast<double>(bottom[i]);
    const auto d = static_cast<double>(bottom[i + 1]);
    const double phase = (0.25 * ((a + b) + (c + d)) - offset_mm) * per_period;
    phases[i] = phase;
    const double in_period = phase - std::floor(phase);
    v[i] = static_cast<FixedPhase>(std::bit_cast<std::uint64_t>(in_period + kTurnsAreLast));
    gx[i] = static_cast<float>(0.5 * ((b + d) - (a + c)) * per_period);
    gy[i] = static_cast<float>(0.5 * ((c + d) - (a + b)) * per_period);
  }
}

void exact_phases(const footprint_kernels::CornerRows& corners,
                  int count,
                  double offset_mm,
                  double per_period,
                  const ExactPhases& out) {
  find_phases(
      corners.top, corners.bottom, count, offset_mm, per_period, out.phase, out.v, out.gx, out.gy);
}

GLINT_WIDE static void find_shapes(const float* __restrict gx,
                                   const float* __restrict gy,
                                   int count,
                                   float* __restrict outer,
                                   float* __restrict inner,
                                   float* __restrict per_major,
                                   float* __restrict per_minor,
                                   float* __restrict flatness) {
  for (int i = 0; i < count; ++i) {
    const Widths widths = widths_of(gx[i], gy[i]);
    outer[i] = widths.outer();
    inner[i] = widths.inner();
    per_major[i] = 1.0F / widths.major;
    per_minor[i] = 1.0F / widths.minor;
    flatness[i] = 0.5F * widths.minor * per_major[i];
  }
}

void box_shapes(const float* gx, const float* gy, int count, const BoxShapes& shapes) {
  find_shapes(gx,
              gy,
              count,
              shapes.outer,
              shapes.inner,
              shapes.per_major,
              shapes.per_minor,
              shapes.flatness);
}

/// As add_box_derivatives(), folded around the middle of the bright stripe.
GLINT_WIDE static void add_folded_derivatives(const FixedPhase* __restrict v,
                                              const float* __restrict outer,
                                              const float* __restrict inner,
                                              const float* __restrict per_major,
                                              const float* __restrict per_minor,
                                              const float* __restrict flatness,
                                              const float* __restrict weight,
                                              int count,
                                              FixedPhase to_middle,
                                              FixedPhase half_duty,
                                              float* __restrict rising,
                                              float* __restrict falling,
                                              float* __restrict by_major,
                                              float* __restrict by_minor,
                                              float* __restrict dark) {
  for (int i = 0; i < count; ++i) {
    const auto turn = static_cast<std::int32_t>(v[i] - to_middle);
    const FixedPhase away = turn < 0 ? to_middle - v[i] : v[i] - to_middle;
    // How far in the bright stripe.
    const float inside = kPerTurn * static_cast<float>(static_cast<std::int32_t>(half_duty - away));
    const float size = absolute(inside);
    const float t = size < outer[i] ? size : outer[i];
    const float over = (t > inner[i] ? t - inner[i] : 0.0F) * per_minor[i];
    const float share = t * per_major[i] - flatness[i] * over * over;
    const float near_weight = size < outer[i] ? weight[i] : 0.0F;
    const float signed_weight = inside < 0.0F ? -near_weight : near_weight;
    const float edge = near_weight * (1.0F - over);
    rising[i] += turn > 0 ? 0.0F : edge;
    falling[i] += turn > 0 ? edge : 0.0F;
    by_major[i] += signed_weight * (0.5F * over - share);
    by_minor[i] += signed_weight * (over * (over - 1.0F));
    dark[i] += weight[i] * (0.5F - (inside < 0.0F ? -share : share));
  }
}

void add_narrow_frame(const FixedPhase* v,
                      const BoxShapes& shapes,
                      const float* weight,
                      int count,
                      double shift,
                      double duty,
                      const NarrowSums& sums) {
  add_folded_derivatives(v,
                         shapes.outer,
                         shapes.inner,
                         shapes.per_major,
                         shapes.per_minor,
                         shapes.flatness,
                         weight,
                         count,
                         fixed_phase_of(shift + 0.5 * duty),
                         fixed_phase_of(0.5 * duty),
                         sums.rising,
                         sums.falling,
                         sums.major,
                         sums.minor,
                         sums.dark);
}

GLINT_WIDE static void unfold(const float* __restrict gx,
                              const float* __restrict gy,
                              const float* __restrict per_major,
                              const float* __restrict rising,
                              const float* __restrict falling,
                              const float* __restrict major,
                              const float* __restrict minor,
                              const float* __restrict dark,
                              int count,
                              float* __restrict by_v,
                              float* __restrict by_gx,
                              float* __restrict by_gy,
                              float* __restrict by_duty,
                              float* __restrict by_dark) {
  for (int i = 0; i < count; ++i) {
    const bool is_steep = absolute(gx[i]) < absolute(gy[i]);
    const float by_major = per_major[i] * major[i];
    const float by_minor = 0.5F * per_major[i] * minor[i];
    const float by_x = is_steep ? by_minor : by_major;
    const float by_y = is_steep ? by_major : by_minor;
    by_v[i] += per_major[i] * (rising[i] - falling[i]);
    by_gx[i] += gx[i] < 0.0F ? -by_x : by_x;
    by_gy[i] += gy[i] < 0.0F ? -by_y : by_y;
    by_duty[i] += per_major[i] * falling[i];
    by_dark[i] += dark[i];
  }
}

void add_narrow_sums(const float* gx,
                     const float* gy,
                     const BoxShapes& shapes,
                     const NarrowSums& sums,
                     int count,
                     const BoxGradients& out) {
  unfold(gx,
         gy,
         shapes.per_major,
         sums.rising,
         sums.falling,
         sums.major,
         sums.minor,
         sums.dark,
         count,
         out.v,
         out.gx,
         out.gy,
         out.duty,
         out.dark);
}

GLINT_WIDE void multiply(const float* __restrict a,
                         const float* __restrict b,
                         int count,
                         float* __restrict out) {
  for (int i = 0; i < count; ++i) {
    out[i] = a[i] * b[i];
  }
}

GLINT_WIDE void multiply_by(const float* __restrict by, int count, float* __restrict to) {
  for (int i = 0; i < count; ++i) {
    to[i] *= by[i];
  }
}

GLINT_WIDE void add_scaled(const float* __restrict from,
                           int count,
                           float factor,
                           float* __restrict to) {
  for (int i = 0; i < count; ++i) {
    to[i] += factor * from[i];
  }
}

GLINT_WIDE void mark_unclipped(const float* __restrict radiance,
                               int count,
                               float linear,
                               float* __restrict marks) {
  for (int i = 0; i < count; ++i) {
    marks[i] = linear * radiance[i] < 1.0F ? 1.0F : 0.0F;
  }
}

GLINT_WIDE double exact_sum(const float* values, std::size_t count) {
  double sums[kDoubleLanes] = {};
  std::size_t i = 0;
  for (; i + kDoubleLanes <= count; i += kDoubleLanes) {
    for (std::size_t lane = 0; lane < kDoubleLanes; ++lane) {
      sums[lane] += static_cast<double>(values[i + lane]);
    }
  }
  double sum = 0.0;
  for (; i < count; ++i) {
    sum += static_cast<double>(values[i]);
  }
  for (const double lane : sums) {
    sum += lane;
  }
  return sum;
}

namespace {

template <class Real>
GLINT_INLINE double dot_of(const float* a, const Real* b, std::size_t count) {
  double sums[kDoubleLanes] = {};
  std::size_t i = 0;
  for (; i + kDoubleLanes <= count; i += kDoubleLanes) {
    for (std::size_t lane = 0; lane < kDoubleLanes; ++lane) {
      sums[lane] += static_cast<double>(a[i + lane]) * static_cast<double>(b[i + lane]);
    }
  }
  double sum = 0.0;
  for (; i < count; ++i) {
    sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  }
  for (const double lane : sums) {
    sum += lane;
  }
  return sum;
}

}  // namespace

GLINT_WIDE double exact_dot(const float* a, const float* b, std::size_t count) {
  return dot_of(a, b, count);
}

GLINT_WIDE double exact_dot(const float* a, const double* b, std::size_t count) {
  return dot_of(a, b, count);
}

}  // namespace glint::gradient_kernels
