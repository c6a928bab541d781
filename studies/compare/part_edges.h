// SPDX-License-Identifier: GPL-3.0-or-later
//
// Offsets told apart by the edge of the part that they belong to: a bore that is off, where the
// outline is right, is another fault than a part that lies elsewhere.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "metrics/overlap/boundary_distance.h"

namespace glint {

/// One closed outline of the simulated part, one of its holes, or a line within it.
struct PartEdge {
  std::string name;  ///< "outline 1", "hole 1", "line 1": each kind the longest first
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();  ///< mean of its points
  std::size_t points = 0;                               ///< with a counterpart, about one a pixel
  double mean_px = 0.0;                                 ///< mean distance of the real edge
  double offset_px = 0.0;                               ///< mean along the normals: > 0 outside
  /// How far the real edge is moved as a whole, least squares over the normals; 0 where the edge
  /// runs one way only.
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
};

/// @param rough    the part's outlines, closed, or lines that end
/// @param located  the same where they were located, in pieces
/// @param gaps     from the located boundaries to the real ones
/// @return edges of at least 20 points with a counterpart, at most 40
std::vector<PartEdge> part_edges(std::span<const Boundary> rough,
                                 std::span<const Boundary> located,
                                 std::span<const BoundaryGap> gaps);

}  // namespace glint
