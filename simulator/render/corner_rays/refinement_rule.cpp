// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/refinement_rule.h"

#include <algorithm>
#include <cmath>

#include "simulator/render/corner_rays/refined_groups.h"

namespace glint {

using Eigen::Vector3d;

int predicted_cells(const CellCheck& check, double max_error_rad, int max_cells) {
  if (!check.is_whole) {
    return std::min(kCellsOfBroken, max_cells);
  }
  if (!std::isfinite(check.error_rad)) {
    return kCellCounts.front();
  }
  for (const int cells : kCellCounts) {
    if (check.error_rad <= max_error_rad * cells * cells) {
      return std::min(cells, max_cells);
    }
  }
  return std::min(kCellsOfBroken, max_cells);  // a neighbour's jump rather than curvature
}

CheckedCells check_cells(const RayGrid& grid, double max_error_rad) {
  CheckedCells cells;
  for (int y = 0; y + 1 < grid.rows; ++y) {
    for (int x = 0; x + 1 < grid.columns; ++x) {
      const CellCheck check = check_cell(grid, x, y);
      const bool is_smooth = check.is_whole && check.error_rad <= max_error_rad;
      cells.is_smooth.push_back(is_smooth ? 1 : 0);
      cells.has_broken = cells.has_broken || !check.is_whole;
      cells.has_bent = cells.has_bent || (check.is_whole && !is_smooth);
    }
  }
  return cells;
}

int next_cells(const CheckedCells& cells, int n, int max_cells) {
  if (cells.has_broken) {
    const int wanted = std::min(kCellsOfBroken, max_cells);
    return n < wanted ? wanted : 0;
  }
  return cells.has_bent && n < max_cells ? 2 * n : 0;
}

bool is_described_by_corners(const RayGrid& grid, double max_error_rad, float clean_weight) {
  const int n = grid.columns - 1;
  const auto direction = [&](int x, int y) {
    const std::size_t i = grid.first + static_cast<std::size_t>(y * grid.columns + x);
    return vector_of(
        grid.rays->direction_x[i], grid.rays->direction_y[i], grid.rays->direction_z[i]);
  };
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      const double u = static_cast<double>(x) / n;
      const double v = static_cast<double>(y) / n;
      const Vector3d bilinear = (1 - v) * ((1 - u) * direction(0, 0) + u * direction(n, 0)) +
                                v * ((1 - u) * direction(0, n) + u * direction(n, n));
      const std::size_t i = grid.first + static_cast<std::size_t>(y * grid.columns + x);
      if (grid.rays->weight[i] != clean_weight ||
          (bilinear - direction(x, y)).norm() > max_error_rad) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace glint
