// SPDX-License-Identifier: GPL-3.0-or-later
//
// The inner loop of the derivative through the table T(w): for a row of pixels the derivatives by
// both phase differences, and the sums of other tables' values, weighted by the pixels'
// derivatives. As in width_kernels.cpp, a chunk of 32 pixels that falls into one or two pieces of a
// table keeps their coefficients in registers. Sums go in a fixed order in double.
// docs/theory/derivatives.md, "Table". Cost: some dozen operations per pixel and table; no memory.
#include "simulator/render/derivative/table_kernels.h"

#include <algorithm>
#include <cstdint>

#include "core/error.h"
#include "core/simd.h"

namespace glint::gradient_kernels {
namespace {

/// Pixels that are looked at together: neighbours mostly share a piece or two.
constexpr int kChunk = 32;

/// A chunk of pixels.
struct Chunk {
  float weight[kChunk];
  std::int32_t piece[kChunk];
  float s[kChunk];  ///< how far into the piece
  std::int32_t lowest, highest;
};

GLINT_INLINE void find_pieces(const float* __restrict w, int pieces, float per_unit, Chunk& chunk) {
  const auto last = static_cast<float>(pieces);
  std::int32_t lowest = pieces - 1;
  std::int32_t highest = 0;
  for (int i = 0; i < kChunk; ++i) {
    const float place = w[i] * per_unit;
    const float at = place < last ? place : last;
    const auto whole = static_cast<std::int32_t>(at);
    const std::int32_t piece = whole < pieces ? whole : pieces - 1;
    const bool counts = chunk.weight[i] != 0.0F;
    chunk.piece[i] = piece;
    chunk.s[i] = at - static_cast<float>(piece);
    const std::int32_t low = counts ? piece : pieces - 1;
    const std::int32_t high = counts ? piece : 0;
    lowest = low < lowest ? low : lowest;
    highest = high > highest ? high : highest;
  }
  chunk.lowest = lowest;
  chunk.highest = highest;
}

/// Values of a table; whatever where there is no derivative.
GLINT_INLINE void look_up(const float* __restrict coefficients,
                          const Chunk& chunk,
                          float* __restrict values) {
  if (chunk.highest - chunk.lowest > 1) {
    for (int i = 0; i < kChunk; ++i) {
      const float* c = coefficients + 4 * chunk.piece[i];
      values[i] = c[0] + chunk.s[i] * (c[1] + chunk.s[i] * (c[2] + chunk.s[i] * c[3]));
    }
    return;
  }
  const float* a = coefficients + 4 * chunk.lowest;
  const float* b = coefficients + 4 * chunk.highest;
  const float a0 = a[0], a1 = a[1], a2 = a[2], a3 = a[3];
  const float b0 = b[0], b1 = b[1], b2 = b[2], b3 = b[3];
  for (int i = 0; i < kChunk; ++i) {
    const bool is_low = chunk.piece[i] == chunk.lowest;
    const float s = chunk.s[i];
    values[i] = (is_low ? a0 : b0) +
                s * ((is_low ? a1 : b1) + s * ((is_low ? a2 : b2) + s * (is_low ? a3 : b3)));
  }
}

/// In halves, the same on any machine.
GLINT_INLINE double total_of(const float* values) {
  double lanes[kChunk];
  for (int i = 0; i < kChunk; ++i) {
    lanes[i] = static_cast<double>(values[i]);
  }
  for (int half = kChunk / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) {
      lanes[i] += lanes[i + half];
    }
  }
  return lanes[0];
}

constexpr int kMaxOthers = 4;

/// Over a row, lane by lane.
struct Sums {
  float products[kChunk] = {};
  float others[kMaxOthers][kChunk] = {};
};

}  // namespace

/// @return whether any pixel has a derivative; if not, nothing is written
GLINT_WIDE static bool add_chunk(const unsigned char* __restrict by_table,
                                 const float* __restrict derivative,
                                 const float* __restrict w,
                                 const float* __restrict top,
                                 const float* __restrict bottom,
                                 float scale,
                                 const Pieces& by_w,
                                 const float* const* __restrict others,
                                 int num_others,
                                 Sums& __restrict sums,
                                 float* __restrict by_gx,
                                 float* __restrict by_gy) {
  Chunk chunk;
  int with_derivative = 0;
  for (int i = 0; i < kChunk; ++i) {
    chunk.weight[i] = by_table[i] != 0 ? derivative[i] : 0.0F;
    with_derivative += chunk.weight[i] != 0.0F ? 1 : 0;
  }
  if (with_derivative == 0) {
    return false;
  }
  find_pieces(w, by_w.count, by_w.per_unit, chunk);
  float values[kChunk];
  for (int other = 0; other < num_others; ++other) {
    look_up(others[other], chunk, values);
    for (int i = 0; i < kChunk; ++i) {
      sums.others[other][i] += chunk.weight[i] != 0.0F ? values[i] * chunk.weight[i] : 0.0F;
    }
  }
  look_up(by_w.coefficients, chunk, values);
  for (int i = 0; i < kChunk; ++i) {
    const float gx = 0.5F * ((top[i + 1] + bottom[i + 1]) - (top[i] + bottom[i]));
    const float gy = 0.5F * ((bottom[i] + bottom[i + 1]) - (top[i] + top[i + 1]));
    const bool counts = (chunk.weight[i] != 0.0F) & (w[i] > 0.0F);
    const float factor = chunk.weight[i] * values[i] * scale / (w[i] > 0.0F ? w[i] : 1.0F);
    by_gx[i] = counts ? factor * gx : 0.0F;
    by_gy[i] = counts ? factor * gy : 0.0F;
    sums.products[i] += counts ? factor * (gx * gx + gy * gy) : 0.0F;
  }
  return true;
}

namespace {

/// The end of a row, as a chunk.
struct LastPixels {
  unsigned char by_table[kChunk] = {};
  float derivative[kChunk] = {};
  float w[kChunk] = {};
  float top[kChunk + 1] = {};
  float bottom[kChunk + 1] = {};
  float by_gx[kChunk] = {};
  float by_gy[kChunk] = {};

  LastPixels(const TableRow& row, int begin) {
    const int count = row.count - begin;
    std::copy_n(row.by_table + begin, count, by_table);
    std::copy_n(row.derivative + begin, count, derivative);
    std::copy_n(row.w + begin, count, w);
    std::copy_n(row.corners.top + begin, count + 1, top);
    std::copy_n(row.corners.bottom + begin, count + 1, bottom);
  }
};

}  // namespace

double table_gradient(const TableRow& row,
                      const Pieces& by_w,
                      const std::vector<const float*>& others,
                      double* sums,
                      float* by_gx,
                      float* by_gy) {
  GLINT_CHECK(others.size() <= kMaxOthers, "no more tables than that at once");
  Sums lanes;
  const auto add = [&](const unsigned char* by_table,
                       const float* derivative,
                       const float* w,
                       const footprint_kernels::CornerRows& corners,
                       float* gx,
                       float* gy) {
    if (!add_chunk(by_table,
                   derivative,
                   w,
                   corners.top,
                   corners.bottom,
                   row.scale,
                   by_w,
                   others.data(),
                   static_cast<int>(others.size()),
                   lanes,
                   gx,
                   gy)) {
      std::fill_n(gx, kChunk, 0.0F);
      std::fill_n(gy, kChunk, 0.0F);
    }
  };
  const int whole = row.count - row.count % kChunk;
  for (int i = 0; i < whole; i += kChunk) {
    add(row.by_table + i,
        row.derivative + i,
        row.w + i,
        {.top = row.corners.top + i, .bottom = row.corners.bottom + i},
        by_gx + i,
        by_gy + i);
  }
  if (whole < row.count) {
    LastPixels last(row, whole);
    add(last.by_table,
        last.derivative,
        last.w,
        {.top = last.top, .bottom = last.bottom},
        last.by_gx,
        last.by_gy);
    std::copy_n(last.by_gx, row.count - whole, by_gx + whole);
    std::copy_n(last.by_gy, row.count - whole, by_gy + whole);
  }
  for (std::size_t i = 0; i < others.size(); ++i) {
    sums[i] += total_of(lanes.others[i]);
  }
  return total_of(lanes.products);
}

}  // namespace glint::gradient_kernels
