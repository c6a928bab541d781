// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/render/footprint/cut_limits.h"

namespace glint::cut_kernels {

/// Hits at the (n + 1)^2 corners of a refined pixel's cells.
struct CornerHits {
  const float* x_mm = nullptr;
  const float* y_mm = nullptr;
  const float* margin_mm = nullptr;
};

/// Tells cells that are lit throughout from those that a boundary of the light may cross. Cells
/// that see the slot or lie beside the wall, at all corners and by the plane through these, are
/// neither.
/// @param is_smooth       1 or 0, row by row; others are neither, too
/// @param cells_per_axis  n, up to kMaxCells
/// @param is_lit, is_cut  set to 1 or 0
void sort_cells(const CornerHits& hits,
                const unsigned char* is_smooth,
                int cells_per_axis,
                const CutLimits& limits,
                unsigned char* is_lit,
                unsigned char* is_cut);

}  // namespace glint::cut_kernels
