// SPDX-License-Identifier: GPL-3.0-or-later
//
// Grids of a checkerboard, put together from the saddle points of a picture.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/image/image.h"
#include "hardware/board/board.h"
#include "hardware/board/saddle_points.h"

namespace glint {

/// A saddle point with its place in a grid. Where the picture shows the grid's front, the rows lie
/// clockwise of the columns.
struct GridCorner {
  int col = 0;
  int row = 0;
  std::size_t point = 0;  ///< its index
  /// Of the square before it, at (col - 1/2, row - 1/2).
  bool is_first_square_dark = false;
};

/// Corners that are joined by edges, each place taken once.
using CornerGrid = std::vector<GridCorner>;

/// The grids among saddle points, the largest first. Two points are neighbours when each is the
/// nearest one along an edge of the other, turned by less than 12 degrees against it, dark and
/// bright lie on opposite sides of the two ends, and the picture half way between them shows the
/// edge; and when steps along one axis differ by less than a factor of 1.6. Grids of fewer than
/// four corners are left out.
/// @param picture  that the points were found in
std::vector<CornerGrid> find_corner_grids(std::span<const SaddlePoint> points,
                                          const ImageF& picture);

/// How a board's corners lie in a grid: the corner (col, row) of the board has the grid's place
/// first + col * along + row * down.
struct GridPlacement {
  Eigen::Vector2i first = {0, 0};
  Eigen::Vector2i along = {1, 0};
  Eigen::Vector2i down = {0, 1};

  Eigen::Vector2i place(int col, int row) const { return first + col * along + row * down; }
};

/// What of a board a grid shows.
struct BoardInGrid {
  /// Every way to lay the board that shows the most of its corners, first square dark where the
  /// grid's colours allow that.
  std::vector<GridPlacement> placements;
  int num_found = 0;   ///< corners of the board that the grid has
  int num_beyond = 0;  ///< corners of the grid that are none of the board, for the best placement
};

/// @param grid  at least one corner
BoardInGrid board_in_grid(const Board& board, const CornerGrid& grid);

}  // namespace glint
