// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/cell_rule.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "simulator/render/corner_rays/cell_kernels.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Second differences of the origin above this share of the cell's width mean a jump.
constexpr double kJumpShare = 0.25;
constexpr double kErrorPerBend = 1.0 / 8.0;
constexpr double kErrorPerKink = 1.0 / 2.0;

Vector3d direction_at(const RayGrid& grid, std::size_t i) {
  return vector_of(grid.rays->direction_x[i], grid.rays->direction_y[i], grid.rays->direction_z[i]);
}

Vector3d origin_at(const RayGrid& grid, std::size_t i) {
  return vector_of(grid.rays->origin_x[i], grid.rays->origin_y[i], grid.rays->origin_z[i]);
}

/// The second differences along an edge of a cell; the larger of both sides.
struct Bend {
  double direction = 0.0;
  double origin_mm = 0.0;
  int sides = 0;  ///< with a neighbour
  /// A cell on one patch has nothing to do with the free triangles beside it.
  bool takes_free = false;
};

class Cell {
 public:
  Cell(const RayGrid& grid, int x, int y) : grid_(grid), x_(x), y_(y) {}

  CellCheck check() const {
    CellCheck result;
    const std::size_t i00 = index(x_, y_);
    const std::size_t i10 = index(x_ + 1, y_);
    const std::size_t i01 = index(x_, y_ + 1);
    const std::size_t i11 = index(x_ + 1, y_ + 1);
    if (!are_alike<4>({i00, i10, i01, i11})) {
      return result;
    }
    const bool has_kinks = is_free(i00) || is_free(i10) || is_free(i01) || is_free(i11);
    Bend along_x = {.takes_free = has_kinks};
    Bend along_y = {.takes_free = has_kinks};
    for (int k = 0; k < 2; ++k) {
      add_bend(x_, y_ + k, 1, 0, along_x);
      add_bend(x_ + k, y_, 0, 1, along_y);
    }
    const double width_mm = std::min(distance_mm(i00, i10), distance_mm(i01, i11));
    const double height_mm = std::min(distance_mm(i00, i01), distance_mm(i10, i11));
    result.is_whole =
        along_x.origin_mm <= kJumpShare * width_mm && along_y.origin_mm <= kJumpShare * height_mm;
    if (along_x.sides == 0 || along_y.sides == 0) {
      result.error_rad = std::numeric_limits<double>::infinity();
      return result;
    }
    const double twist = (direction_at(grid_, i11) - direction_at(grid_, i10) -
                          direction_at(grid_, i01) + direction_at(grid_, i00))
                             .norm();
    const double per_bend = has_kinks ? kErrorPerKink * grid_.kink_factor : kErrorPerBend;
    result.error_rad = per_bend * (along_x.direction + along_y.direction) + kErrorPerBend * twist;
    return result;
  }

 private:
  std::size_t index(int x, int y) const {
    return grid_.first + static_cast<std::size_t>(y * grid_.columns + x);
  }

  /// True for a triangle that belongs to no exact patch.
  bool is_free(std::size_t i) const { return grid_.piece[i] < 0; }

  /// All met the part once, and no two of them different patches. Whether a free triangle goes on
  /// smoothly beside a patch, or beside another one, is told by the differences.
  template <std::size_t kCount>
  bool are_alike(const std::array<std::size_t, kCount>& rays) const {
    std::int32_t patch = -1;
    for (const std::size_t i : rays) {
      if (grid_.path[i] != RayPath::kOnce ||
          (patch >= 0 && !is_free(i) && grid_.piece[i] != patch)) {
        return false;
      }
      patch = std::max(patch, grid_.piece[i]);
    }
    return true;
  }

  double distance_mm(std::size_t i, std::size_t j) const {
    return (origin_at(grid_, i) - origin_at(grid_, j)).norm();
  }

  /// The edge from (x, y) to (x + dx, y + dy), with the corners before and after it.
  void add_bend(int x, int y, int dx, int dy, Bend& bend) const {
    add_side({x - dx, y - dy}, {x, y}, {x + dx, y + dy}, bend);
    add_side({x, y}, {x + dx, y + dy}, {x + 2 * dx, y + 2 * dy}, bend);
  }

  struct Place {
    int x = 0;
    int y = 0;
  };

  void add_side(const Place& a, const Place& b, const Place& c, Bend& bend) const {
    if (a.x < 0 || a.y < 0 || c.x >= grid_.columns || c.y >= grid_.rows) {
      return;
    }
    const std::size_t i = index(a.x, a.y);
    const std::size_t j = index(b.x, b.y);
    const std::size_t k = index(c.x, c.y);
    if (!are_alike<3>({i, j, k}) || (!bend.takes_free && (is_free(i) || is_free(k)))) {
      return;
    }
    ++bend.sides;
    const Vector3d turned =
        direction_at(grid_, i) - 2.0 * direction_at(grid_, j) + direction_at(grid_, k);
    const Vector3d moved = origin_at(grid_, i) - 2.0 * origin_at(grid_, j) + origin_at(grid_, k);
    bend.direction = std::max(bend.direction, turned.norm());
    bend.origin_mm = std::max(bend.origin_mm, moved.norm());
  }

  const RayGrid& grid_;
  int x_;
  int y_;
};

}  // namespace

CellCheck check_cell(const RayGrid& grid, int x, int y) {
  return Cell(grid, x, y).check();
}

void mark_smooth_row(const RayGrid& grid, int y, double max_error_rad, std::uint8_t* is_smooth) {
  if (y < 1 || y + 2 >= grid.rows) {
    std::fill_n(is_smooth, grid.columns - 1, std::uint8_t{0});
    return;
  }
  std::array<CornerLine, 4> lines;
  for (int k = 0; k < 4; ++k) {
    const std::size_t first =
        grid.first + static_cast<std::size_t>(y - 1 + k) * static_cast<std::size_t>(grid.columns);
    const RayCache& rays = *grid.rays;
    lines[static_cast<std::size_t>(k)] = {
        .direction = {rays.direction_x.data() + first,
                      rays.direction_y.data() + first,
                      rays.direction_z.data() + first},
        .origin = {rays.origin_x.data() + first,
                   rays.origin_y.data() + first,
                   rays.origin_z.data() + first},
        .path = reinterpret_cast<const std::uint8_t*>(grid.path + first),
        .piece = grid.piece + first};
  }
  mark_smooth_cells(lines.data(),
                    grid.columns - 1,
                    {.wanted_path = static_cast<std::uint8_t>(RayPath::kOnce),
                     .max_error_rad = static_cast<float>(max_error_rad),
                     .max_jump_share = static_cast<float>(kJumpShare),
                     .error_per_bend = static_cast<float>(kErrorPerBend),
                     .error_per_kink = static_cast<float>(kErrorPerKink * grid.kink_factor)},
                    is_smooth);
}

}  // namespace glint
