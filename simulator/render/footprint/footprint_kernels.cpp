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

using footprint_lane::absolute;
using footprint_lane::first_integral;
using footprint_lane::kNarrow;
using footprint_lane::Range;
using footprint_lane::range_of;
using footprint_lane::second_integral;
using footprint_lane::second_integral_shifted;
using footprint_lane::Widths;
using footprint_lane::widths_of;

/// Share of a trapezoid beyond 0 at distance d from its middle, less one half; odd in d.
GLINT_INLINE float beyond(float d, float outer, float inner, float per_major, float per_both) {
  const float size = absolute(d);
  const float t = size < outer ? size : outer;
  const float over = t > inner ? t - inner : 0.0F;
  return std::copysign(t * per_major - over * over * per_both, d);
}

/// The bright share less one half where at most one edge is near: folded around the middle of the
/// bright stripe.
GLINT_INLINE float one_edge_rest(
    float from_middle, float half_duty, float outer, float inner, float per_major, float per_both) {
  const float turn = from_middle - std::floor(from_middle + 0.5F);
  return beyond(half_duty - absolute(turn), outer, inner, per_major, per_both);
}

/// The same where both edges of a stripe may be near.
GLINT_INLINE float two_edge_rest(
    float moved, float duty, float outer, float inner, float per_major, float per_both) {
  const float f = moved - std::floor(moved);
  const float rise = beyond(f, outer, inner, per_major, per_both);
  const float fall = beyond(f - duty, outer, inner, per_major, per_both);
  const float next = beyond(f - 1.0F, outer, inner, per_major, per_both);
  return rise - fall + next;
}

/// What corner_codes() says of a corner.
enum CornerCode : unsigned char {
  kOnWall = 1,
  kOffWall = 2,
  kRightOfSlot = 4,
  kLeftOfSlot = 8,
  kInSlot = 16,
  kInsideEnds = 32
};

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

GLINT_WIDE void corner_codes(const float* __restrict x_mm,
                             const float* __restrict y_mm,
                             const float* __restrict margin_mm,
                             int count,
                             const LitLimits& limits,
                             unsigned char* __restrict codes) {
  const LitLimits l = limits;
  for (int i = 0; i < count; ++i) {
    const float x = x_mm[i];
    const float y = y_mm[i];
    const float margin = margin_mm[i];
    int code = margin >= 0.0F ? kOnWall : 0;
    code |= margin < 0.0F ? kOffWall : 0;
    code |= y >= l.half_slot_mm ? kRightOfSlot : 0;
    code |= y <= -l.half_slot_mm ? kLeftOfSlot : 0;
    code |= ((y > -l.half_slot_mm) & (y < l.half_slot_mm)) ? kInSlot : 0;
    code |= ((x > l.x_low_mm) & (x < l.x_high_mm)) ? kInsideEnds : 0;
    codes[i] = static_cast<unsigned char>(code);
  }
}

namespace {

/// 1 where the stripes at a pixel's corners differ by no more than `widest`.
GLINT_WIDE void mark_narrow(const float* __restrict top,
                            const float* __restrict bottom,
                            int count,
                            float widest_mm,
                            unsigned char* __restrict is_narrow) {
  for (int i = 0; i < count; ++i) {
    const Range v = range_of(top, bottom, i);
    is_narrow[i] = v.high - v.low <= widest_mm ? 1 : 0;
  }
}

/// @param state  1 for narrow pixels, else 0; the result
GLINT_WIDE void combine_codes(const unsigned char* __restrict top,
                              const unsigned char* __restrict bottom,
                              const unsigned char* __restrict kind,
                              const unsigned char* __restrict hidden,
                              int count,
                              unsigned char* __restrict state) {
  constexpr unsigned char kLit = kOnWall | kInsideEnds;
  for (int i = 0; i < count; ++i) {
    const auto all = static_cast<unsigned char>(top[i] & top[i + 1] & bottom[i] & bottom[i + 1]);
    const bool is_beside_slot = (all & (kRightOfSlot | kLeftOfSlot)) != 0;
    const bool is_never_lit = (all & (kOffWall | kInSlot)) != 0;
    const bool is_plain = ((all & kLit) == kLit) & is_beside_slot & (state[i] != 0);
    const unsigned char other = is_never_lit ? 0 : 2;
    const unsigned char by_light = is_plain ? 1 : other;
    const unsigned char by_kind = kind[i] == 2 ? 2 : by_light;
    const bool is_dark = (kind[i] == 0) | (hidden[i] != 0);
    state[i] = is_dark ? 0 : by_kind;
  }
}

}  // namespace

void classify(const unsigned char* top,
              const unsigned char* bottom,
              const CornerRows& stripes_mm,
              const unsigned char* kind,
              const unsigned char* hidden,
              int count,
              const LitLimits& limits,
              unsigned char* state) {
  mark_narrow(stripes_mm.top, stripes_mm.bottom, count, limits.widest_mm, state);
  combine_codes(top, bottom, kind, hidden, count, state);
}

GLINT_WIDE void even_tiles(const TileRow& tiles,
                           int count,
                           const LitLimits& limits,
                           unsigned char* __restrict is_even) {
  const TileRow t = tiles;
  const LitLimits l = limits;
  for (int i = 0; i < count; ++i) {
    const bool is_beside_slot = (t.y_low[i] >= l.half_slot_mm) | (t.y_high[i] <= -l.half_slot_mm);
    const bool is_inside = (t.x_low[i] > l.x_low_mm) & (t.x_high[i] < l.x_high_mm);
    const bool is_narrow = t.stripes_high[i] - t.stripes_low[i] <= l.widest_mm;
    const bool is_lit = (t.margin_low[i] >= 0.0F) & is_beside_slot & is_inside & is_narrow;
    is_even[i] = ((t.kind[i] == 2) | ((t.kind[i] == 1) & is_lit)) ? 1 : 0;
  }
}

GLINT_WIDE void plain_states(const unsigned char* __restrict kind,
                             const unsigned char* __restrict hidden,
                             int count,
                             unsigned char* __restrict state) {
  for (int i = 0; i < count; ++i) {
    state[i] = hidden[i] != 0 ? 0 : kind[i];
  }
}

GLINT_WIDE void half_widths(const float* __restrict gx,
                            const float* __restrict gy,
                            int count,
                            float* __restrict outer,
                            float* __restrict inner) {
  for (int i = 0; i < count; ++i) {
    const Widths widths = widths_of(gx[i], gy[i]);
    outer[i] = widths.outer();
    inner[i] = widths.inner();
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

/// The trapezoid is the second difference of a second integral.
GLINT_WIDE void any_shares(const float* __restrict v,
                           const float* __restrict gx,
                           const float* __restrict gy,
                           int count,
                           double scale,
                           double duty,
                           float* __restrict shares) {
  constexpr double kNarrowest = 1e-4;
  for (int i = 0; i < count; ++i) {
    const double middle = scale * static_cast<double>(v[i]);
    const double x = scale * static_cast<double>(absolute(gx[i]));
    const double y = scale * static_cast<double>(absolute(gy[i]));
    const double a = x > kNarrowest ? x : kNarrowest;
    const double b = y > kNarrowest ? y : kNarrowest;
    const double outer = 0.5 * (a + b);
    const double inner = 0.5 * (a - b);
    const double difference =
        second_integral(middle + outer, duty) - second_integral(middle + inner, duty) -
        second_integral(middle - inner, duty) + second_integral(middle - outer, duty);
    shares[i] = static_cast<float>(duty + difference / (a * b));
  }
}

namespace {

/// Of one footprint, phases and widths already times the scale.
GLINT_INLINE float wide_share(float f, float duty, float outer, float inner) {
  constexpr float kNarrowest = 1e-3F;
  const float major = outer + inner;
  const float minor = outer - inner > kNarrowest ? outer - inner : kNarrowest;
  const float far = 0.5F * (major + minor);
  const float near = 0.5F * (major - minor);
  const float shifted = f + (1.0F - duty);
  const auto integral_at = [&](float moved) {
    return second_integral_shifted(shifted + moved, duty);
  };
  const float difference =
      (integral_at(far) - integral_at(near)) - (integral_at(-near) - integral_at(-far));
  return duty + difference / (major * minor);
}

struct WidthRange {
  float least;
  float largest;
};

GLINT_WIDE WidthRange range_of_widths(const float* __restrict outer, int count) {
  WidthRange range = {.least = outer[0], .largest = outer[0]};
  for (int i = 0; i < count; ++i) {
    range.least = outer[i] < range.least ? outer[i] : range.least;
    range.largest = outer[i] > range.largest ? outer[i] : range.largest;
  }
  return range;
}

GLINT_WIDE void wide_shares(const float* __restrict v,
                            const float* __restrict outers,
                            const float* __restrict inners,
                            int count,
                            float scale,
                            float duty,
                            float* __restrict shares) {
  for (int i = 0; i < count; ++i) {
    const float moved = scale * v[i];
    shares[i] = wide_share(moved - std::floor(moved), duty, scale * outers[i], scale * inners[i]);
  }
}

/// Leaves wide footprints alone.
GLINT_WIDE void trapezoid_shares(const float* __restrict v,
                                 const float* __restrict outers,
                                 const float* __restrict inners,
                                 int count,
                                 float scale,
                                 float duty,
                                 float* __restrict shares) {
  const float limit = duty < 1.0F - duty ? duty : 1.0F - duty;
  const float narrowest = scale * kNarrow;
  for (int i = 0; i < count; ++i) {
    const float moved = scale * v[i];
    const float f = moved - std::floor(moved);
    const float outer = scale * outers[i];
    const float inner = scale * inners[i];
    const float major = outer + inner;
    const float minor = outer - inner > narrowest ? outer - inner : narrowest;
    const float per_major = 1.0F / major;
    const float trapezoid =
        0.5F + two_edge_rest(f, duty, outer, inner, per_major, 0.5F * per_major / minor);
    shares[i] = outer <= limit ? trapezoid : shares[i];
  }
}

}  // namespace

/// Footprints no wider than the stripes take the trapezoid, which does not cancel however small
/// they are; others the second difference of the second integral, taken near phase 0. Where all of
/// a chunk take the same, only that is computed.
void any_shares_fast(const float* v,
                     const float* outer,
                     const float* inner,
                     int count,
                     float scale,
                     float duty,
                     float* shares) {
  constexpr int kChunk = 64;
  constexpr float kRounding = 1e-6F;  // of the limit times the scale
  const float limit = (duty < 1.0F - duty ? duty : 1.0F - duty) / scale;
  for (int begin = 0; begin < count; begin += kChunk) {
    const int size = begin + kChunk < count ? kChunk : count - begin;
    const WidthRange widths = range_of_widths(outer + begin, size);
    if (widths.largest > (1.0F - kRounding) * limit) {
      wide_shares(v + begin, outer + begin, inner + begin, size, scale, duty, shares + begin);
    }
    if (widths.least <= (1.0F + kRounding) * limit) {
      trapezoid_shares(v + begin, outer + begin, inner + begin, size, scale, duty, shares + begin);
    }
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
