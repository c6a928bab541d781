// SPDX-License-Identifier: GPL-3.0-or-later
//
// When four neighbouring rays describe everything between them: the rule behind kSmooth and
// is_smooth of corner_rays.h.
#pragma once

#include <cstdint>

#include "simulator/render/ray_cache/packet_tracer.h"

namespace glint {

/// Rays through the crossings of a grid on the image, row by row; arrays as in RayCache.
struct RayGrid {
  const RayCache* rays = nullptr;
  const RayPath* path = nullptr;
  const std::int32_t* piece = nullptr;
  std::size_t first = 0;  ///< of the grid, in all arrays
  int columns = 0;
  int rows = 0;
  double kink_factor = 1.0;  ///< by which errors at free triangles count more
};

/// One cell of a grid.
struct CellCheck {
  /// All four corners met the part once, not on different patches, without a jump between them.
  bool is_whole = false;
  /// Estimated error [rad] of rays taken as bilinear between the corners; infinite when there are
  /// no neighbours to tell.
  double error_rad = 0.0;
};

/// Checks the cell whose first corner is (x, y).
///
/// A linear rule over a cell of width 1 errs by f'' / 8; f'' is taken from the second differences
/// with the neighbours on both sides (the larger counts), the mixed derivative from the twist of
/// the cell. Across the edge of two triangles a direction has a kink; there the error is up to a
/// half of the second difference. So it is where one of the corners is on a triangle without a
/// patch: such triangles may go on beside a patch smoothly or not.
CellCheck check_cell(const RayGrid& grid, int x, int y);

/// Marks the cells of row y that are surely smooth (whole, and with an error of at most
/// max_error_rad), quickly and for most of them; those marked 0 need check_cell().
/// @param is_smooth  columns - 1 marks
void mark_smooth_row(const RayGrid& grid, int y, double max_error_rad, std::uint8_t* is_smooth);

}  // namespace glint
