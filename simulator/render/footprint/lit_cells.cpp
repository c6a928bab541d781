// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sorts the cells of a refined pixel into those that are lit throughout, those that a boundary of
// the light may cross, and dark ones, by the smallest and the largest of each coordinate over four
// corners. A plane through the corners misses them by the twist of the cell; for calling a cell
// dark the bounds are widened by it. docs/theory/footprints.md, "When four corners are not enough".
// Cost: a few comparisons per cell, without branches; no memory.
#include "simulator/render/footprint/lit_cells.h"

#include "core/simd.h"
#include "simulator/render/footprint/footprint_lane.h"

namespace glint::cut_kernels {
namespace {

using footprint_lane::Range;
using footprint_lane::range_of;

/// By which a plane through the four corners of cell i misses them.
GLINT_INLINE float twist_of(const float* top, const float* bottom, int i) {
  const float twist = 0.25F * ((top[i] - top[i + 1]) - (bottom[i] - bottom[i + 1]));
  return twist < 0.0F ? -twist : twist;
}

}  // namespace

GLINT_WIDE void sort_cells(const CornerHits& hits,
                           const unsigned char* __restrict is_smooth,
                           int cells_per_axis,
                           const CutLimits& limits,
                           unsigned char* __restrict is_lit,
                           unsigned char* __restrict is_cut) {
  const int n = cells_per_axis;
  const auto half_slot_mm = static_cast<float>(limits.half_slot_mm);
  const float x_low_mm = limits.x_low_mm;
  const float x_high_mm = limits.x_high_mm;
  for (int row = 0; row < n; ++row) {
    const int corner = row * (n + 1);
    const int cell = row * n;
    const float* __restrict x_mm = hits.x_mm + corner;
    const float* __restrict y_mm = hits.y_mm + corner;
    const float* __restrict margin_mm = hits.margin_mm + corner;
    for (int i = 0; i < n; ++i) {
      const Range x = range_of(x_mm, x_mm + n + 1, i);
      const Range y = range_of(y_mm, y_mm + n + 1, i);
      const Range margin = range_of(margin_mm, margin_mm + n + 1, i);
      const float y_twist = twist_of(y_mm, y_mm + n + 1, i);
      const float margin_twist = twist_of(margin_mm, margin_mm + n + 1, i);
      const bool is_beside_slot = (y.low >= half_slot_mm) | (y.high <= -half_slot_mm);
      const bool is_in_slot = (y.low - y_twist > -half_slot_mm) & (y.high + y_twist < half_slot_mm);
      const bool is_inside_ends = (x.low > x_low_mm) & (x.high < x_high_mm);
      const bool is_used = is_smooth[cell + i] != 0;
      const bool is_bright = is_used & (margin.low >= 0.0F) & is_beside_slot & is_inside_ends;
      const bool is_dark = is_in_slot | (margin.high + margin_twist < 0.0F);
      is_lit[cell + i] = is_bright ? 1 : 0;
      is_cut[cell + i] = (is_used & !is_bright & !is_dark) ? 1 : 0;
    }
  }
}

}  // namespace glint::cut_kernels
