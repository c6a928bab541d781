// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/corner_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace glint {
namespace {

constexpr double kAligned = 0.978;  ///< cosine of 12 degrees
constexpr std::size_t kMinCorners = 4;
const std::array<Eigen::Vector2i, 4> step_of_side = {
    Eigen::Vector2i(1, 0), Eigen::Vector2i(0, 1), Eigen::Vector2i(-1, 0), Eigen::Vector2i(0, -1)};

/// The other end of an edge.
struct Link {
  std::size_t point = std::numeric_limits<std::size_t>::max();  ///< none
  std::size_t edge = 0;                                         ///< of that point
  double distance_px = std::numeric_limits<double>::infinity();

  bool exists() const { return point != std::numeric_limits<std::size_t>::max(); }
};

using Links = std::vector<std::array<Link, 4>>;

double nearest_grey(const ImageF& image, const Eigen::Vector2d& at_px) {
  const int x = std::clamp(static_cast<int>(at_px.x()), 0, image.width() - 1);
  const int y = std::clamp(static_cast<int>(at_px.y()), 0, image.height() - 1);
  return static_cast<double>(image(x, y));
}

/// Whether the picture half way along edge k of a point is bright and dark on the right sides.
bool shows_edge(const ImageF& picture,
                const SaddlePoint& point,
                std::size_t k,
                const Eigen::Vector2d& step) {
  const Eigen::Vector2d middle = point.at_px + 0.5 * step;
  const Eigen::Vector2d across =
      Eigen::Vector2d(-step.y(), step.x()) * std::max(0.15, std::min(0.4, 1.5 / step.norm()));
  const double rise =
      nearest_grey(picture, middle + across) - nearest_grey(picture, middle - across);
  return (k % 2 == 0 ? rise : -rise) > 0.25 * point.contrast;
}

/// The edge of a point that a direction runs along; 4 when there is none.
std::size_t edge_along(const SaddlePoint& point, const Eigen::Vector2d& direction) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (point.edges[k].dot(direction) > kAligned) {
      return k;
    }
  }
  return 4;
}

/// The nearest point along each edge of one, whether or not it is the nearest of that one, too.
std::array<Link, 4> nearest_along(std::span<const SaddlePoint> points,
                                  std::size_t i,
                                  const ImageF& picture) {
  constexpr double kNearestPx = 4.0;
  std::array<Link, 4> links;
  for (std::size_t j = 0; j < points.size(); ++j) {
    const Eigen::Vector2d step = points[j].at_px - points[i].at_px;
    const double distance = step.norm();
    if (distance < kNearestPx) {
      continue;
    }
    const Eigen::Vector2d direction = step / distance;
    const std::size_t k = edge_along(points[i], direction);
    if (k == 4 || distance >= links[k].distance_px) {
      continue;
    }
    const std::size_t back = edge_along(points[j], -direction);
    if (back != 4 && (back + k) % 2 == 1 && shows_edge(picture, points[i], k, step)) {
      links[k] = {.point = j, .edge = back, .distance_px = distance};
    }
  }
  return links;
}

Links mutual_links(std::span<const SaddlePoint> points, const ImageF& picture) {
  Links nearest(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    nearest[i] = nearest_along(points, i, picture);
  }
  Links links = nearest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      Link& link = links[i][k];
      if (link.exists() && nearest[link.point][link.edge].point != i) {
        link = {};
      }
    }
  }
  return links;
}

/// Lengths of steps along the columns and rows near a corner; 0: not known yet.
using Steps = std::array<double, 2>;

/// Neighbouring steps along one axis differ by perspective, less than that factor.
bool fits(double step, double known) {
  constexpr double kMaxRatio = 1.6;
  return known <= 0.0 || (step < kMaxRatio * known && known < kMaxRatio * step);
}

/// The shorter link of each axis.
Steps first_steps(const std::array<Link, 4>& links) {
  Steps steps = {};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double shorter = std::min(links[axis].distance_px, links[axis + 2].distance_px);
    steps[axis] = std::isfinite(shorter) ? shorter : 0.0;
  }
  return steps;
}

/// All points that links lead to from a first one. `turns[i]` quarter turns take the edges of point
/// i to those of the grid; it is negative where a point is in no grid yet.
CornerGrid grown_grid(const Links& links, std::size_t first, std::vector<int>& turns) {
  const auto corner = [&](std::size_t point, const Eigen::Vector2i& at) {
    // Between edges 0 and 1 it is bright; before the corner, between 2 and 3 of the grid, so is it
    // after an even number of turns.
    return GridCorner{.col = at.x(),
                      .row = at.y(),
                      .point = point,
                      .is_first_square_dark = turns[point] % 2 != 0};
  };
  std::map<std::pair<int, int>, std::size_t> taken = {{{0, 0}, first}};
  turns[first] = 0;
  std::vector<Steps> steps = {first_steps(links[first])};
  CornerGrid grid = {corner(first, {0, 0})};
  for (std::size_t next = 0; next < grid.size(); ++next) {
    const GridCorner from = grid[next];
    for (std::size_t k = 0; k < 4; ++k) {
      const Link& link = links[from.point][k];
      if (!link.exists() || turns[link.point] >= 0) {
        continue;
      }
      const std::size_t side = (k + static_cast<std::size_t>(turns[from.point])) % 4;
      const Eigen::Vector2i at = Eigen::Vector2i(from.col, from.row) + step_of_side[side];
      Steps known = steps[next];
      if (!fits(link.distance_px, known[side % 2])) {
        continue;
      }
      known[side % 2] = link.distance_px;
      if (!taken.try_emplace({at.x(), at.y()}, link.point).second) {
        continue;
      }
      turns[link.point] = static_cast<int>((side + 6 - link.edge) % 4);
      grid.push_back(corner(link.point, at));
      steps.push_back(known);
    }
  }
  return grid;
}

/// The places a grid has, as a table with a border of places that it has not.
class Places {
 public:
  explicit Places(const CornerGrid& grid) {
    low_ = high_ = Eigen::Vector2i(grid.front().col, grid.front().row);
    for (const GridCorner& corner : grid) {
      low_ = low_.cwiseMin(Eigen::Vector2i(corner.col, corner.row));
      high_ = high_.cwiseMax(Eigen::Vector2i(corner.col, corner.row));
    }
    sums_ = Eigen::ArrayXXi::Zero(size().x() + 1, size().y() + 1);
    for (const GridCorner& corner : grid) {
      sums_(corner.col - low_.x() + 1, corner.row - low_.y() + 1) = 1;
    }
    for (int x = 1; x < sums_.rows(); ++x) {
      for (int y = 1; y < sums_.cols(); ++y) {
        sums_(x, y) += sums_(x - 1, y) + sums_(x, y - 1) - sums_(x - 1, y - 1);
      }
    }
  }

  const Eigen::Vector2i& low() const { return low_; }

  Eigen::Vector2i size() const { return high_ - low_ + Eigen::Vector2i::Ones(); }

  /// How many places are taken in a rectangle, which may reach beyond the grid.
  int count(const Eigen::Vector2i& first, const Eigen::Vector2i& extent) const {
    const Eigen::Vector2i begin = (first - low_).cwiseMax(0).cwiseMin(size());
    const Eigen::Vector2i end = (first - low_ + extent).cwiseMax(0).cwiseMin(size());
    return sums_(end.x(), end.y()) - sums_(begin.x(), end.y()) - sums_(end.x(), begin.y()) +
           sums_(begin.x(), begin.y());
  }

 private:
  Eigen::Vector2i low_;
  Eigen::Vector2i high_;
  Eigen::ArrayXXi sums_;
};

/// The four ways a board can lie on a rectangle, each with its extent in the grid.
std::vector<std::pair<GridPlacement, Eigen::Vector2i>> turned_boards(const Board& board) {
  std::vector<std::pair<GridPlacement, Eigen::Vector2i>> result;
  for (std::size_t turn = 0; turn < 4; ++turn) {
    GridPlacement placement = {.along = step_of_side[turn], .down = step_of_side[(turn + 1) % 4]};
    const Eigen::Vector2i last = placement.place(board.cols - 1, board.rows - 1);
    const Eigen::Vector2i low = last.cwiseMin(0);
    placement.first = -low;  // so that its lowest place is (0, 0)
    result.emplace_back(placement, last.cwiseAbs() + Eigen::Vector2i::Ones());
  }
  return result;
}

/// All placements with the most corners.
void add_placements(const Board& board, const Places& places, BoardInGrid& best) {
  for (const auto& [turned, extent] : turned_boards(board)) {
    const Eigen::Vector2i slack = (places.size() - extent).cwiseAbs();
    const Eigen::Vector2i begin = places.low() - (extent - places.size()).cwiseMax(0);
    for (int x = 0; x <= slack.x(); ++x) {
      for (int y = 0; y <= slack.y(); ++y) {
        const Eigen::Vector2i low = begin + Eigen::Vector2i(x, y);
        const int found = places.count(low, extent);
        if (found < best.num_found) {
          continue;
        }
        if (found > best.num_found) {
          best.placements.clear();
          best.num_found = found;
        }
        GridPlacement placement = turned;
        placement.first += low;
        best.placements.push_back(placement);
      }
    }
  }
}

/// Colours alternate, so one corner tells those of all squares.
bool is_first_dark(const CornerGrid& grid, const GridPlacement& placement) {
  const GridCorner& known = grid.front();
  const Eigen::Vector2i away = placement.first - Eigen::Vector2i(known.col, known.row);
  // The square before the board's first corner, on both of its axes.
  const Eigen::Vector2i before = -(placement.along + placement.down);
  const Eigen::Vector2i shift = (before + Eigen::Vector2i::Ones()) / 2;  // from (-1, -1)
  const bool is_even = (away.x() + away.y() + shift.x() + shift.y()) % 2 == 0;
  return is_even == known.is_first_square_dark;
}

}  // namespace

std::vector<CornerGrid> find_corner_grids(std::span<const SaddlePoint> points,
                                          const ImageF& picture) {
  const Links links = mutual_links(points, picture);
  std::vector<int> turns(points.size(), -1);
  std::vector<CornerGrid> grids;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (turns[i] >= 0) {
      continue;
    }
    CornerGrid grid = grown_grid(links, i, turns);
    if (grid.size() >= kMinCorners) {
      grids.push_back(std::move(grid));
    }
  }
  std::ranges::stable_sort(grids, std::greater<>(), &CornerGrid::size);
  return grids;
}

BoardInGrid board_in_grid(const Board& board, const CornerGrid& grid) {
  BoardInGrid best;
  add_placements(board, Places(grid), best);
  best.num_beyond = static_cast<int>(grid.size()) - best.num_found;
  const auto is_light = [&](const GridPlacement& placement) {
    return !is_first_dark(grid, placement);
  };
  if (!std::ranges::all_of(best.placements, is_light)) {
    std::erase_if(best.placements, is_light);
  }
  return best;
}

}  // namespace glint
