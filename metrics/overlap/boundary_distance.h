// SPDX-License-Identifier: GPL-3.0-or-later
//
// Distances between two boundaries, in both directions.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "metrics/overlap/boundary.h"

namespace glint {

/// From a point of one boundary to the nearest point of the other one.
struct BoundaryGap {
  BoundaryPoint from;
  double distance_px = 0.0;  ///< >= 0
  double offset_px = 0.0;    ///< of the other one along the normal: > 0 when it lies outside
  std::size_t boundary = 0;  ///< indices of the point
  std::size_t point = 0;
};

/// Gaps of all points whose nearest neighbour is at most that far. Points whose neighbour is the
/// loose end of a line are left out: the other side was not found there.
/// Cost: linear in the points, by a grid of cells.
std::vector<BoundaryGap> gaps_between(std::span<const Boundary> from,
                                      std::span<const Boundary> to,
                                      double max_distance_px = 20.0);

struct BoundaryDistance {
  double mean_px = 0.0;  ///< over both directions (average symmetric surface distance)
  double p95_px = 0.0;   ///< 95th percentile of both directions together (HD95)
  double max_px = 0.0;
  double offset_px = 0.0;  ///< mean of the second along the normals of the first: > 0 larger
  std::size_t points = 0;  ///< of both boundaries that took part
  double share = 0.0;      ///< of all points of both boundaries
};

/// @param max_distance_px  points without a neighbour that near are counted in `share` alone
BoundaryDistance boundary_distance(std::span<const Boundary> first,
                                   std::span<const Boundary> second,
                                   double max_distance_px = 20.0);

}  // namespace glint
