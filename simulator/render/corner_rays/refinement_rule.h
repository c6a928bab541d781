// SPDX-License-Identifier: GPL-3.0-or-later
//
// Into how many cells a pixel is cut: from its four corners, then from the cells it was cut into.
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/render/corner_rays/cell_rule.h"

namespace glint {

/// For pixels that hold a silhouette or several kinds of paths: no number makes them smooth.
inline constexpr int kCellsOfBroken = 8;

/// Cells per axis by which an error falling as 1/n^2 comes below the limit.
/// @param max_cells  the largest number that is allowed
int predicted_cells(const CellCheck& check, double max_error_rad, int max_cells);

/// What the cells of a cut pixel are like.
struct CheckedCells {
  std::vector<std::uint8_t> is_smooth;
  bool has_bent = false;    ///< whole, but with too large an error
  bool has_broken = false;  ///< not whole
};

/// @param grid  the corners of the cells
CheckedCells check_cells(const RayGrid& grid, double max_error_rad);

/// The number of cells per axis to try after n, at most max_cells; 0: the pixel is done.
int next_cells(const CheckedCells& cells, int n, int max_cells);

/// True when all rays of a cut pixel agree with its four corners and none is weakened by a stain:
/// closed forms take uncut pixels for clean.
bool is_described_by_corners(const RayGrid& grid, double max_error_rad, float clean_weight);

}  // namespace glint
