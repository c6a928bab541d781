// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a grid that shows a checkerboard to its corners at full resolution, or to what is wrong.
#pragma once

#include <span>
#include <vector>

#include "hardware/board/board.h"
#include "hardware/board/board_view.h"
#include "hardware/board/corner_fit.h"
#include "hardware/board/corner_grid.h"
#include "hardware/board/picture_levels.h"

namespace glint {

/// All corners of a board, those that the grid lacks too, measured and judged: outcome kNoBoard
/// when some cannot be measured or do not lie on a plane, else as in find_board.h. Of several
/// placements that is taken which has the mark in its first square; without a mark that whose +x
/// points most to the right.
/// @param level       that points and grid are from
/// @param placements  at least one
BoardView measured_board(PictureLevels& levels,
                         const Board& board,
                         int level,
                         std::span<const SaddlePoint> points,
                         const CornerGrid& grid,
                         std::span<const GridPlacement> placements);

/// Fitted corners with their places on the board, as a view, or why not: too blurred, too dark.
/// @param col_row  of each corner
/// @param clearance_px  of each corner to the next edges
BoardView judged_corners(const Board& board,
                         std::span<const Eigen::Vector2i> col_row,
                         std::span<const CornerFit> fits,
                         std::span<const double> clearance_px);

/// What lies beside an incomplete grid.
struct MissingPart {
  bool reaches_border = false;  ///< the grid would go on outside the picture
  double clipped_share = 0.0;   ///< of the pixels where it would go on inside
};

MissingPart missing_part(PictureLevels& levels,
                         const Board& board,
                         int level,
                         std::span<const SaddlePoint> points,
                         const CornerGrid& grid);

}  // namespace glint
