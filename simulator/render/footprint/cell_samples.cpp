// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cells of a refined pixel as samples of the stripes: phase and gradient are the mean and the mean
// differences of a cell's four corners, its weight the mean gain times its share of the pixel.
// Cells whose corners do not belong together get weight 0 by a mask instead of a branch, and the
// number of cells is a template's argument, so that a row is one vector. Limits of places are taken
// in sixteen lanes that are joined at the end. Own derivation: docs/theory/footprints.md, "When
// four corners are not enough". Cost: some 30 operations a cell, linear in cells; memory: the
// caller's rows.
#include "simulator/render/footprint/cell_samples.h"

#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/simd.h"
#include "simulator/render/footprint/corner_lane.h"

namespace glint::cut_kernels {
namespace {

using corner_lane::larger;
using corner_lane::smaller;

constexpr int kLanes = 16;

/// The smallest of values, lane by lane, where there is weight.
struct Lowest {
  float lanes[kLanes];

  GLINT_INLINE void add(int lane, float value, float weight) {
    const bool is_lower = (weight > 0.0F) & (value < lanes[lane]);
    lanes[lane] = is_lower ? value : lanes[lane];
  }

  GLINT_INLINE float value() const {
    float low = lanes[0];
    for (const float lane : lanes) {
      low = lane < low ? lane : low;
    }
    return low;
  }
};

}  // namespace

GLINT_WIDE PlaceLimits find_limits(const float* __restrict x_mm,
                                   const float* __restrict y_mm,
                                   const float* __restrict margin_mm,
                                   const float* __restrict weight,
                                   int count) {
  constexpr float kHuge = 3e38F;
  Lowest x, to_x, y, to_y, margin;
  for (int lane = 0; lane < kLanes; ++lane) {
    x.lanes[lane] = to_x.lanes[lane] = y.lanes[lane] = to_y.lanes[lane] = kHuge;
    margin.lanes[lane] = kHuge;
  }
  const int whole = count < kLanes ? 0 : count;
  for (int at = 0; at < count - whole; ++at) {
    x.add(at, x_mm[at], weight[at]);
    to_x.add(at, -x_mm[at], weight[at]);
    y.add(at, y_mm[at], weight[at]);
    to_y.add(at, -y_mm[at], weight[at]);
    margin.add(at, margin_mm[at], weight[at]);
  }
  for (int i = 0; i < whole; i += kLanes) {
    const int first = i < count - kLanes ? i : count - kLanes;  // the last ones may count twice
    for (int lane = 0; lane < kLanes; ++lane) {
      const int at = first + lane;
      x.add(lane, x_mm[at], weight[at]);
      to_x.add(lane, -x_mm[at], weight[at]);
      y.add(lane, y_mm[at], weight[at]);
      to_y.add(lane, -y_mm[at], weight[at]);
      margin.add(lane, margin_mm[at], weight[at]);
    }
  }
  return {.x_low_mm = x.value(),
          .x_high_mm = -to_x.value(),
          .y_low_mm = y.value(),
          .y_high_mm = -to_y.value(),
          .margin_low_mm = margin.value()};
}

namespace {

/// The value, or 0 for a mask of 0: without a branch.
GLINT_INLINE float kept(float value, std::int32_t mask) {
  return std::bit_cast<float>(std::bit_cast<std::int32_t>(value) & mask);
}

/// A row of cells. @tparam kCells  per axis; known to the compiler, a row is a vector or less
template <int kCells>
GLINT_INLINE void sample_row(const float* __restrict top,
                             const float* __restrict gain_top,
                             const std::int32_t* __restrict used,
                             float offset_mm,
                             float per_mm,
                             float* __restrict v,
                             float* __restrict gx,
                             float* __restrict gy,
                             float* __restrict gain,
                             float* __restrict widest) {
  constexpr float kQuarterShare = 0.25F / static_cast<float>(kCells * kCells);
  const float* __restrict bottom = top + kCells + 1;
  const float* __restrict gain_bottom = gain_top + kCells + 1;
  for (int i = 0; i < kCells; ++i) {
    const float a = top[i];
    const float b = top[i + 1];
    const float c = bottom[i];
    const float d = bottom[i + 1];
    const float width = larger(larger(a, b), larger(c, d)) - smaller(smaller(a, b), smaller(c, d));
    const float sum = gain_top[i] + gain_top[i + 1] + gain_bottom[i] + gain_bottom[i + 1];
    v[i] = kept((0.25F * (a + b + c + d) - offset_mm) * per_mm, used[i]);
    gx[i] = kept(0.5F * (b + d - a - c) * per_mm, used[i]);
    gy[i] = kept(0.5F * (c + d - a - b) * per_mm, used[i]);
    gain[i] = kept(kQuarterShare * sum, used[i]);
    widest[i] = larger(widest[i], kept(width, used[i]));
  }
}

template <int kCells>
GLINT_INLINE float sample_rows(const CellGrid& cells,
                               float offset_mm,
                               float per_mm,
                               const CellSamples& out) {
  std::int32_t used[static_cast<std::size_t>(kCells * kCells)];
  for (int i = 0; i < kCells * kCells; ++i) {
    used[i] = -static_cast<std::int32_t>(cells.is_smooth[i]);
  }
  float widths[static_cast<std::size_t>(kCells)] = {};
  for (int row = 0; row < kCells; ++row) {
    const std::ptrdiff_t first = row * kCells;
    sample_row<kCells>(cells.stripes_mm + first + row,
                       cells.gain + first + row,
                       used + first,
                       offset_mm,
                       per_mm,
                       out.v + first,
                       out.gx + first,
                       out.gy + first,
                       out.gain + first,
                       widths);
  }
  float widest = 0.0F;
  for (const float width : widths) {
    widest = larger(widest, width);
  }
  return widest;
}

}  // namespace

GLINT_WIDE float sample_cells(const CellGrid& cells,
                              float offset_mm,
                              float per_mm,
                              const CellSamples& out) {
  switch (cells.cells_per_axis) {
    case 2:
      return sample_rows<2>(cells, offset_mm, per_mm, out);
    case 4:
      return sample_rows<4>(cells, offset_mm, per_mm, out);
    case 8:
      return sample_rows<8>(cells, offset_mm, per_mm, out);
    case 16:
      return sample_rows<16>(cells, offset_mm, per_mm, out);
    default:
      return __builtin_inff();
  }
}

GLINT_WIDE void corner_weights(const unsigned char* __restrict is_smooth,
                               int cells_per_axis,
                               float* __restrict weight) {
  const int n = cells_per_axis;
  const float quarter = 0.25F / static_cast<float>(n * n);
  // Quarters of the cells in a row of them, with nothing on both sides.
  float above[kMaxCells + 2] = {};
  float below[kMaxCells + 2] = {};
  for (int row = 0; row <= n; ++row) {
    const bool is_last = row == n;
    const float full = is_last ? 0.0F : quarter;
    const unsigned char* __restrict cells = is_smooth + (is_last ? 0 : row) * n;
    for (int i = 0; i < n; ++i) {
      below[i + 1] = full * static_cast<float>(1 - static_cast<std::int32_t>(cells[i]));
    }
    float* __restrict out = weight + row * (n + 1);
    for (int i = 0; i <= n; ++i) {
      out[i] = (above[i] + above[i + 1]) + (below[i] + below[i + 1]);
    }
    for (int i = 1; i <= n; ++i) {
      above[i] = below[i];
    }
  }
}

}  // namespace glint::cut_kernels
