// SPDX-License-Identifier: GPL-3.0-or-later
//
// Edges inside a part, between its bright and its dark places: print, holes, ends of a coating.
// They tell where the part is when its outline is not to be seen. docs/theory/comparison.md
#pragma once

#include <cstddef>
#include <vector>

#include "core/image/image.h"
#include "metrics/overlap/boundary.h"

namespace glint {

/// How far from a line of the simulated picture edges are looked for, along its normal.
inline constexpr double kInnerReachPx = 8.0;

struct InnerEdges {
  std::vector<Boundary> lines;      ///< where the simulated picture, smoothed, has the level
  std::vector<Boundary> simulated;  ///< edges beside them, from points where both pictures have one
  std::vector<Boundary> real;       ///< edges of the real picture from the same points
  std::size_t points = 0;           ///< of the lines at which the simulated picture has an edge
  std::size_t paired = 0;           ///< of these, those at which the real one has its counterpart
  double mean_px = 0.0;  ///< along the normals, of edges from one point, >= 0; 0: no pair

  /// Paired over all points, in [0, 1]; 0 without points.
  double share() const;
  /// Mean distance over all points, the reach where the counterpart is missing; in [0, 8] px.
  double distance_px() const;
};

/// Edges along the lines on which 3 x 3 means of the simulated picture have a level, and those of
/// the real picture beside them. Both pictures are searched from the points of the lines within the
/// reach; an edge counts where grey falls to the same side as on the line, so that the other side
/// of a bar is no counterpart. A pattern that is moved by its whole period looks as before. Lines
/// of less than 20 points are left out.
/// @param simulated  height x width, shares of full scale, as `real` is
/// @param level      grey between bright and dark
/// @param inside     edges elsewhere are left out; of the pictures' size, or empty: nowhere
InnerEdges inner_edges(const ImageF& simulated,
                       const ImageF& real,
                       float level,
                       const Mask& inside = {});

}  // namespace glint
