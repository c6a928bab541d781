// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops around the table T(w) of clipped_mean.h: the width of each pixel's stripes and
// whether their phase is linear over the blur; look-up of the table's cubic pieces; cosine series
// by Clenshaw's recurrence. The widths of neighbouring pixels mostly fall into one or two pieces of
// the table: such a chunk of 32 pixels keeps the coefficients in registers, and only others gather
// them. docs/theory/clipped_mean.md. Cost: some ten operations per pixel and quantity; no memory.
#include "simulator/render/scan/width_kernels.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include "core/simd.h"
#include "simulator/render/footprint/footprint_lane.h"

namespace glint::footprint_kernels {
namespace {

using footprint_lane::absolute;

GLINT_INLINE float width_of(float x, float y, const LinearPhase& r) {
  return std::sqrt(r.variance_px2 * (x * x + y * y));
}

/// @param xx, xy, yy  differences over two pixels
GLINT_INLINE unsigned char is_straight(
    float xx, float xy, float yy, float width, const LinearPhase& r) {
  const float mixed = absolute(xx) > absolute(xy) ? absolute(xx) : absolute(xy);
  const float bend = 0.5F * (mixed > absolute(yy) ? mixed : absolute(yy)) * r.variance_px2;
  const bool is_small = (bend <= r.absolute) | (bend <= r.relative * width);
  return static_cast<unsigned char>(is_small ? 1 : 0);
}

/// @param piece  of each width @param s  how far into it, in pieces
GLINT_INLINE void pieces_of(const float* __restrict w,
                            int count,
                            int pieces,
                            float per_unit,
                            std::int32_t* __restrict piece,
                            float* __restrict s) {
  const auto last = static_cast<float>(pieces);
  for (int i = 0; i < count; ++i) {
    const float place = w[i] * per_unit;
    const float at = place < last ? place : last;
    const auto whole = static_cast<std::int32_t>(at);
    piece[i] = whole < pieces ? whole : pieces - 1;
    s[i] = at - static_cast<float>(piece[i]);
  }
}

GLINT_INLINE int piece_of(float w, const PieceTables& t) {
  const auto last = static_cast<float>(t.pieces - 1);
  const float place = w * t.per_unit;
  return static_cast<int>(place < last ? place : last);
}

/// Places of the mask in one piece, or in it and the next: no coefficients to be gathered.
template <bool has_two>
GLINT_INLINE void look_up_near(const unsigned char* __restrict mask,
                               const float* __restrict w,
                               int count,
                               const PieceTables& t,
                               int piece,
                               const PieceValues& none,
                               float* __restrict cubic,
                               float* __restrict straight) {
  const float* a = t.coefficients + 4 * piece;
  const float* b = has_two ? a + 4 : a;
  const float* node = t.nodes + piece;
  const float a0 = a[0], a1 = a[1], a2 = a[2], a3 = a[3];
  const float b0 = b[0], b1 = b[1], b2 = b[2], b3 = b[3];
  const float low = node[0], low_rise = node[1] - node[0];
  const float high = node[1], high_rise = has_two ? node[2] - node[1] : 0.0F;
  const float other = none.cubic, other_straight = none.straight;
  const auto begin = static_cast<float>(piece);
  const float next = begin + 1.0F;
  const auto end = static_cast<float>(t.pieces);
  for (int i = 0; i < count; ++i) {
    const float place = w[i] * t.per_unit;
    const float at = place < end ? place : end;
    const bool is_low = !has_two | (at < next);
    const float s = at - (is_low ? begin : next);
    const float value =
        (is_low ? a0 : b0) +
        s * ((is_low ? a1 : b1) + s * ((is_low ? a2 : b2) + s * (is_low ? a3 : b3)));
    const float line = (is_low ? low : high) + s * (is_low ? low_rise : high_rise);
    cubic[i] = mask[i] != 0 ? value : other;
    straight[i] = mask[i] != 0 ? line : other_straight;
  }
}

}  // namespace

GLINT_WIDE void stripe_widths(const ThreeRows& gx,
                              const ThreeRows& gy,
                              int count,
                              const LinearPhase& rule,
                              float* __restrict w,
                              unsigned char* __restrict is_linear) {
  const float* __restrict x_above = gx.above;
  const float* __restrict x_here = gx.here;
  const float* __restrict x_below = gx.below;
  const float* __restrict y_above = gy.above;
  const float* __restrict y_here = gy.here;
  const float* __restrict y_below = gy.below;
  const LinearPhase r = rule;
  for (int i = 0; i < count; ++i) {
    w[i] = width_of(x_here[i], y_here[i], r);
  }
  // The ends apart: without them neighbours are just one place further on.
  const int last = count - 1;
  for (int i = 1; i < last; ++i) {
    is_linear[i] = is_straight(
        x_here[i + 1] - x_here[i - 1], x_below[i] - x_above[i], y_below[i] - y_above[i], w[i], r);
  }
  for (const int i : {0, last}) {
    const float xx = x_here[i < last ? i + 1 : last] - x_here[i > 0 ? i - 1 : 0];
    is_linear[i] = is_straight(xx, x_below[i] - x_above[i], y_below[i] - y_above[i], w[i], r);
  }
}

GLINT_WIDE void look_up_where(const unsigned char* __restrict mask,
                              const float* __restrict w,
                              int count,
                              const PieceTables& tables,
                              const PieceValues& other,
                              float* __restrict cubic,
                              float* __restrict straight) {
  constexpr int kChunk = 32;
  const PieceTables t = tables;
  const PieceValues none = other;
  for (int begin = 0; begin < count; begin += kChunk) {
    const int size = count - begin < kChunk ? count - begin : kChunk;
    const float* __restrict widths = w + begin;
    const unsigned char* __restrict is_used = mask + begin;
    float* __restrict values = cubic + begin;
    float* __restrict lines = straight + begin;
    // Numbers that are not negative are ordered as their bits are.
    std::int32_t minimum = std::numeric_limits<std::int32_t>::max();
    std::int32_t maximum = 0;
    for (int i = 0; i < size; ++i) {
      const auto bits = std::bit_cast<std::int32_t>(widths[i]);
      minimum = bits < minimum ? bits : minimum;
      maximum = bits > maximum ? bits : maximum;
    }
    const int lowest = piece_of(std::bit_cast<float>(minimum), t);
    const int highest = piece_of(std::bit_cast<float>(maximum), t);
    if (lowest == highest) {
      look_up_near<false>(is_used, widths, size, t, lowest, none, values, lines);
    } else if (lowest + 1 == highest) {
      look_up_near<true>(is_used, widths, size, t, lowest, none, values, lines);
    } else {
      std::int32_t piece[kChunk];
      float s[kChunk];
      pieces_of(widths, size, t.pieces, t.per_unit, piece, s);
      for (int i = 0; i < size; ++i) {
        const float* c = t.coefficients + 4 * piece[i];
        const float* node = t.nodes + piece[i];
        const float value = c[0] + s[i] * (c[1] + s[i] * (c[2] + s[i] * c[3]));
        const float line = node[0] + s[i] * (node[1] - node[0]);
        values[i] = is_used[i] != 0 ? value : none.cubic;
        lines[i] = is_used[i] != 0 ? line : none.straight;
      }
    }
  }
}

GLINT_WIDE void phase_differences(
    const CornerRows& corners, int count, float scale, float* __restrict gx, float* __restrict gy) {
  const float* __restrict top = corners.top;
  const float* __restrict bottom = corners.bottom;
  const float half = 0.5F * scale;
  for (int i = 0; i < count; ++i) {
    const float a = top[i] + bottom[i];
    const float b = top[i + 1] + bottom[i + 1];
    const float above = top[i] + top[i + 1];
    const float below = bottom[i] + bottom[i + 1];
    gx[i] = (b - a) * half;
    gy[i] = (below - above) * half;
  }
}

/// Clenshaw's recurrence, for some places at once.
GLINT_WIDE void cosine_series(const double* __restrict terms,
                              int size,
                              double mean,
                              const double* __restrict cosines,
                              int count,
                              double* __restrict values) {
  constexpr int kChunk = 32;
  for (int begin = 0; begin < count; begin += kChunk) {
    const int places = count - begin < kChunk ? count - begin : kChunk;
    const double* __restrict cosine = cosines + begin;
    double next[kChunk] = {};
    double after[kChunk] = {};
    for (int k = size - 1; k >= 0; --k) {
      for (int i = 0; i < places; ++i) {
        const double here = terms[k] + 2.0 * cosine[i] * next[i] - after[i];
        after[i] = next[i];
        next[i] = here;
      }
    }
    for (int i = 0; i < places; ++i) {
      values[begin + i] = mean + next[i] * cosine[i] - after[i];
    }
  }
}

GLINT_WIDE void add_in_squares(const unsigned char* __restrict mask,
                               const float* __restrict more,
                               int count,
                               bool has_any,
                               float* __restrict deviation) {
  for (int begin = 0; begin < count; begin += kRun) {
    const float added = more[begin / kRun];
    const int size = count - begin < kRun ? count - begin : kRun;
    const unsigned char* __restrict is_used = mask + begin;
    float* __restrict values = deviation + begin;
    if (added > 0.0F && has_any) {
      for (int i = 0; i < size; ++i) {
        const float sum = std::sqrt(values[i] * values[i] + added * added);
        values[i] = is_used[i] != 0 ? sum : values[i];
      }
    } else if (added > 0.0F && size == kRun) {
      for (int i = 0; i < kRun; ++i) {
        values[i] = is_used[i] != 0 ? added : values[i];
      }
    } else if (added > 0.0F) {
      for (int i = 0; i < size; ++i) {
        values[i] = is_used[i] != 0 ? added : values[i];
      }
    }
  }
}

GLINT_WIDE void multiply_runs(const unsigned char* __restrict mask,
                              const float* __restrict factors,
                              int count,
                              float* __restrict values) {
  for (int begin = 0; begin < count; begin += kRun) {
    const float factor = factors[begin / kRun];
    const int size = count - begin < kRun ? count - begin : kRun;
    const unsigned char* __restrict is_used = mask + begin;
    float* __restrict run = values + begin;
    for (int i = 0; i < size; ++i) {
      run[i] = is_used[i] != 0 ? factor * run[i] : run[i];
    }
  }
}

}  // namespace glint::footprint_kernels
