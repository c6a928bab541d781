// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the fit of a corner begins, from a grid of saddle points on a plane.
#pragma once

#include <map>
#include <span>
#include <utility>

#include <Eigen/Core>

#include "hardware/board/board_plane.h"
#include "hardware/board/corner_fit.h"
#include "hardware/board/corner_grid.h"

namespace glint {

/// Guesses of corners: at the point that was found there, else where the plane says. Keeps the
/// plane and the points by reference.
class CornerGuesses {
 public:
  /// @param level  that points and grid are from
  /// @param plane  from places of the grid to px of the picture
  /// @param grid   at least one corner
  CornerGuesses(int level,
                const BoardPlane& plane,
                std::span<const SaddlePoint> points,
                const CornerGrid& grid);

  /// @param place  column and row in the grid, also beyond it
  CornerGuess operator()(const Eigen::Vector2i& place) const;

 private:
  int level_;
  const BoardPlane& plane_;
  std::span<const SaddlePoint> points_;
  GridCorner known_;
  std::map<std::pair<int, int>, std::size_t> point_at_;
};

}  // namespace glint
