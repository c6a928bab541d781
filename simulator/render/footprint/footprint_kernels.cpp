// SPDX-License-Identifier: GPL-3.0-or-later
//
// Radiance of pixels that lie entirely on the lit wall, a row at a time. Over such a pixel the
// phase of the stripes is taken as linear, so the bright share beyond an edge is the distribution
// function of the sum of two uniform variables: a straight line in the middle with a parabola at
// each end (box_frame() and its relatives). Footprints wider than the stripes take the second
// difference of the twice integrated square wave instead (any_shares()). The file also classifies
// pixels by their four corners. Own derivation: docs/theory/footprints.md. Cost: a few dozen
// operations per pixel and frame, without branches so that the loops vectorise; no memory beyond
// the caller's rows.
#include "simulator/render/footprint/footprint_kernels.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/simd.h"
#include "simulator/light/tunnel/cos_turns.h"
#include "simulator/render/footprint/footprint_lane.h"

namespace glint::footprint_kernels {
namespace {

using footprint_lane::first_integral;
using footprint_lane::one_edge_rest;
using footprint_lane::second_integral;
using footprint_lane::two_edge_rest;
using footprint_lane::Widths;
using footprint_lane::widths_of;

}  // namespace

GLINT_WIDE void phases_of_corners(
    const CornerRows& corners, int count, float offset, float scale, const PhaseRow& out) {
  const float* __restrict top = corners.top;
  const float* __restrict bottom = corners.bottom;
  float* __restrict v = out.v;
  float* __restrict gx = out.gx;
  float* __restrict gy = out.gy;
  const float half = 0.5F * scale;
  for (int i = 0; i < count; ++i) {
    const float a = top[i] + bottom[i];
    const float b = top[i + 1] + bottom[i + 1];
    const float above = top[i] + top[i + 1];
    const float below = bottom[i] + bottom[i + 1];
    v[i] = (0.25F * (a + b) - offset) * scale;
    gx[i] = (b - a) * half;
    gy[i] = (below - above) * half;
  }
}

/// Places are first moved by whole periods, without rounding: by multiples of a period of 12 bits,
/// and then by what that lacks of the true one.
GLINT_WIDE void phases_in_period(
    const CornerRows& corners, int count, double offset, double scale, const PhaseRow& out) {
  const float* __restrict top = corners.top;
  const float* __restrict bottom = corners.bottom;
  float* __restrict v = out.v;
  float* __restrict gx = out.gx;
  float* __restrict gy = out.gy;
  const double period = 1.0 / scale;
  const auto period_bits = std::bit_cast<std::uint32_t>(static_cast<float>(period));
  const auto short_period = std::bit_cast<float>(period_bits & 0xFFFFF000U);
  const auto lacking = static_cast<float>(period - static_cast<double>(short_period));
  const auto begin = static_cast<float>((offset * scale - std::round(offset * scale)) * period);
  const auto per_mm = static_cast<float>(scale);
  const auto per_mm_rest = static_cast<float>(scale - static_cast<double>(per_mm));
  const float half = 0.5F * per_mm;
  for (int i = 0; i < count; ++i) {
    const float whole = std::floor(top[i] * per_mm + 0.5F);
    const float base = whole * short_period;
    const float left_top = top[i] - base;
    const float left_bottom = bottom[i] - base;
    const float right_top = top[i + 1] - base;
    const float right_bottom = bottom[i + 1] - base;
    const float left = left_top + left_bottom;
    const float right = right_top + right_bottom;
    const float place = 0.25F * (left + right) - (whole * lacking + begin);
    v[i] = place * per_mm + place * per_mm_rest;
    gx[i] = (right - left) * half;
    gy[i] = ((left_bottom + right_bottom) - (left_top + right_top)) * half;
  }
}

GLINT_WIDE void trapezoids(const float* __restrict gx,
                           const float* __restrict gy,
                           int count,
                           const Trapezoids& out) {
  float* __restrict outer = out.outer;
  float* __restrict inner = out.inner;
  float* __restrict per_major = out.per_major;
  float* __restrict per_both = out.per_both;
  for (int i = 0; i < count; ++i) {
    const Widths widths = widths_of(gx[i], gy[i]);
    outer[i] = widths.outer();
    inner[i] = widths.inner();
    per_major[i] = 1.0F / widths.major;
    per_both[i] = 0.5F / (widths.major * widths.minor);
  }
}

/// Which formula a footprint gets is its own matter, so that its neighbours do not change its bits.
GLINT_WIDE void box_frame(const float* __restrict v,
                          const Trapezoids& trapezoids,
                          const float* __restrict gain,
                          int count,
                          const BoxFrame& frame,
                          float* __restrict out) {
  const float* __restrict outer = trapezoids.outer;
  const float* __restrict inner = trapezoids.inner;
  const float* __restrict per_major = trapezoids.per_major;
  const float* __restrict per_both = trapezoids.per_both;
  const float shift = frame.shift;
  const float duty = frame.duty;
  const float half_duty = 0.5F * duty;
  const float to_middle = shift + half_duty;
  const float bright = 1.0F - frame.dark;
  const float middle = frame.dark + 0.5F * bright;
  const float limit = narrow_limit(duty);
  for (int i = 0; i < count; ++i) {
    const float wide =
        two_edge_rest(v[i] - shift, duty, outer[i], inner[i], per_major[i], per_both[i]);
    const float narrow =
        one_edge_rest(v[i] - to_middle, half_duty, outer[i], inner[i], per_major[i], per_both[i]);
    out[i] = gain[i] * (middle + bright * (outer[i] <= limit ? narrow : wide));
  }
}

GLINT_WIDE void narrow_box_frame(const float* __restrict v,
                                 const Trapezoids& trapezoids,
                                 const float* __restrict gain,
                                 int count,
                                 const BoxFrame& frame,
                                 float* __restrict out) {
  const float* __restrict outer = trapezoids.outer;
  const float* __restrict inner = trapezoids.inner;
  const float* __restrict per_major = trapezoids.per_major;
  const float* __restrict per_both = trapezoids.per_both;
  const float half_duty = 0.5F * frame.duty;
  const float to_middle = frame.shift + half_duty;
  const float bright = 1.0F - frame.dark;
  const float middle = frame.dark + 0.5F * bright;
  for (int i = 0; i < count; ++i) {
    const float rest =
        one_edge_rest(v[i] - to_middle, half_duty, outer[i], inner[i], per_major[i], per_both[i]);
    out[i] = gain[i] * (middle + bright * rest);
  }
}

GLINT_WIDE void opposite_frame(const float* __restrict frame,
                               const float* __restrict gain,
                               int count,
                               float dark,
                               float* __restrict out) {
  const float both = 1.0F + dark;
  for (int i = 0; i < count; ++i) {
    out[i] = both * gain[i] - frame[i];
  }
}

/// Numbers that are not negative are ordered as their bits are.
GLINT_WIDE float largest(const float* __restrict values, int count) {
  std::int32_t found = 0;
  for (int i = 0; i < count; ++i) {
    const auto bits = std::bit_cast<std::int32_t>(values[i]);
    found = bits > found ? bits : found;
  }
  return std::bit_cast<float>(found);
}

GLINT_WIDE float largest_lit(const float* __restrict values,
                             const float* __restrict gain,
                             int count) {
  std::int32_t found = 0;
  for (int i = 0; i < count; ++i) {
    const auto bits = std::bit_cast<std::int32_t>(gain[i] > 0.0F ? values[i] : 0.0F);
    found = bits > found ? bits : found;
  }
  return std::bit_cast<float>(found);
}

GLINT_WIDE void plain_gains(const unsigned char* __restrict state,
                            const float* __restrict weight,
                            const float* __restrict cosine,
                            int count,
                            float* __restrict gain) {
  for (int i = 0; i < count; ++i) {
    const float full = weight[i];
    gain[i] = state[i] == 1 ? full : 0.0F;
  }
  for (int i = 0; cosine != nullptr && i < count; ++i) {
    gain[i] *= cosine[i];
  }
}

GLINT_WIDE void even_gains(const unsigned char* __restrict state,
                           float weight,
                           const float* __restrict cosine,
                           int count,
                           float* __restrict gain) {
  for (int i = 0; i < count; ++i) {
    gain[i] = state[i] == 1 ? weight : 0.0F;
  }
  for (int i = 0; cosine != nullptr && i < count; ++i) {
    gain[i] *= cosine[i];
  }
}

GLINT_WIDE void mix_beside_cells(const unsigned char* __restrict state,
                                 const float* __restrict gain,
                                 const float* __restrict share,
                                 int count,
                                 float dark,
                                 float bright,
                                 float* __restrict out) {
  for (int i = 0; i < count; ++i) {
    const float mixed = gain[i] * (dark + bright * share[i]);
    out[i] = state[i] == 2 ? out[i] : mixed;
  }
}

GLINT_WIDE void shine_beside_cells(const unsigned char* __restrict state,
                                   const float* __restrict dark,
                                   const float* __restrict gain,
                                   int count,
                                   float* __restrict out) {
  for (int i = 0; i < count; ++i) {
    // Where there is no light the place is none.
    const float mixed = gain[i] > 0.0F ? out[i] + dark[i] * (gain[i] - out[i]) : out[i];
    out[i] = state[i] == 2 ? out[i] : mixed;
  }
}

GLINT_WIDE void means_of_corners(const CornerRows& corners, int count, float* __restrict out) {
  const float* __restrict top = corners.top;
  const float* __restrict bottom = corners.bottom;
  for (int i = 0; i < count; ++i) {
    out[i] = 0.25F * ((top[i] + top[i + 1]) + (bottom[i] + bottom[i + 1]));
  }
}

namespace {

/// In pairs, so that additions do not wait for each other.
GLINT_INLINE float sum_of_lanes(const float* lanes) {
  float half[kLanes / 2];
  for (int i = 0; i < kLanes / 2; ++i) {
    half[i] = lanes[i] + lanes[i + kLanes / 2];
  }
  float quarter[kLanes / 4];
  for (int i = 0; i < kLanes / 4; ++i) {
    quarter[i] = half[i] + half[i + kLanes / 4];
  }
  return (quarter[0] + quarter[2]) + (quarter[1] + quarter[3]);
}

}  // namespace

GLINT_WIDE void sum_box_frames(const float* __restrict v,
                               const Trapezoids& trapezoids,
                               const float* __restrict gain,
                               int count,
                               const double* __restrict shift,
                               int frames,
                               double duty,
                               double dark,
                               double bright,
                               bool is_narrow,
                               double* __restrict out) {
  const float* __restrict outer = trapezoids.outer;
  const float* __restrict inner = trapezoids.inner;
  const float* __restrict per_major = trapezoids.per_major;
  const float* __restrict per_both = trapezoids.per_both;
  const auto width = static_cast<float>(duty);
  float lit[kLanes] = {};
  for (int i = 0; i < count; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      lit[lane] += gain[i + lane];
    }
  }
  const auto sum_lit = static_cast<double>(sum_of_lanes(lit));
  for (int k = 0; k < frames; ++k) {
    const auto by = static_cast<float>(shift[k]);
    const float to_middle = by + 0.5F * width;
    float rest[kLanes] = {};
    for (int i = 0; is_narrow && i < count; i += kLanes) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const int at = i + lane;
        rest[lane] +=
            gain[at] *
            one_edge_rest(
                v[at] - to_middle, 0.5F * width, outer[at], inner[at], per_major[at], per_both[at]);
      }
    }
    for (int i = 0; !is_narrow && i < count; i += kLanes) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const int at = i + lane;
        rest[lane] +=
            gain[at] *
            two_edge_rest(v[at] - by, width, outer[at], inner[at], per_major[at], per_both[at]);
      }
    }
    out[k] += (dark + 0.5 * bright) * sum_lit + bright * static_cast<double>(sum_of_lanes(rest));
  }
}

/// The second integral has mean zero up to the constant that the sum of c takes out.
GLINT_WIDE void sum_vertices(const double* v,
                             const double* c,
                             const double* e,
                             int vertices,
                             const double* __restrict shift,
                             int frames,
                             double duty,
                             double* __restrict out) {
  for (int j = 0; j < vertices; ++j) {
    const double vj = v[j];
    const double cj = c[j];
    const double ej = e[j];
    for (int k = 0; k < frames; ++k) {
      const double moved = vj - shift[k];
      out[k] += cj * second_integral(moved, duty) + ej * first_integral(moved, duty);
    }
  }
}

GLINT_WIDE void modulate(const float* __restrict x_mm,
                         int count,
                         const Unevenness& uneven,
                         float* __restrict out) {
  const Unevenness u = uneven;
  const float per_half_length = 1.0F / u.half_length_mm;
  for (int i = 0; i < count; ++i) {
    const float x = x_mm[i] - u.shift_mm;
    const float end = x * per_half_length;
    const float led = (1.0F + u.ripple * cos_turns(x * u.per_mm)) / (1.0F + u.ripple);
    const float factor = led * (1.0F - u.falloff * end * end);
    out[i] *= factor > 0.0F ? factor : 0.0F;
  }
}

}  // namespace glint::footprint_kernels
