// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/corner_guesses.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

/// Half of one step along the board as it appears, and of one down.
struct LocalAxes {
  Eigen::Vector2d along_px;
  Eigen::Vector2d down_px;

  /// Distance between parallel edges, the smaller of both ways.
  double clearance_px() const {
    const double area = std::abs(along_px.x() * down_px.y() - along_px.y() * down_px.x());
    return area / std::max(along_px.norm(), down_px.norm());
  }
};

LocalAxes axes_at(const BoardPlane& plane, const Eigen::Vector2d& place) {
  const Eigen::Vector2d x(0.5, 0.0);
  const Eigen::Vector2d y(0.0, 0.5);
  return {.along_px = plane(place + x) - plane(place - x),
          .down_px = plane(place + y) - plane(place - y)};
}

/// The corner of a grid at a place, where to begin its fit.
CornerGuess guess_at(const BoardPlane& plane, const Eigen::Vector2i& place, bool is_dark_before) {
  const LocalAxes axes = axes_at(plane, place.cast<double>());
  const Eigen::Vector2d along = axes.along_px.normalized();
  const Eigen::Vector2d down = axes.down_px.normalized();
  // As dark as the square before the corner is the one after it, between +x and +y.
  return {.at_px = plane(place.cast<double>()),
          .rising = is_dark_before ? down : along,
          .falling = is_dark_before ? Eigen::Vector2d(-along) : down,
          .clearance_px = axes.clearance_px()};
}

}  // namespace

CornerGuesses::CornerGuesses(int level,
                             const BoardPlane& plane,
                             std::span<const SaddlePoint> points,
                             const CornerGrid& grid)
    : level_(level), plane_(plane), points_(points), known_(grid.front()) {
  for (const GridCorner& corner : grid) {
    point_at_[{corner.col, corner.row}] = corner.point;
  }
}

CornerGuess CornerGuesses::operator()(const Eigen::Vector2i& place) const {
  const bool is_even = (place.x() + place.y() - known_.col - known_.row) % 2 == 0;
  CornerGuess guess = guess_at(plane_, place, is_even == known_.is_first_square_dark);
  const auto found = point_at_.find({place.x(), place.y()});
  if (found != point_at_.end()) {
    guess.at_px = points_[found->second].at_px * (1 << level_);
  }
  return guess;
}

}  // namespace glint
