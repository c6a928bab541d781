// SPDX-License-Identifier: GPL-3.0-or-later
//
// Edges inside a part, between its bright and its dark places: print, holes, ends of a coating.
// They tell where the part is when its outline is not to be seen. docs/theory/comparison.md
#pragma once

#include <vector>

#include "core/image/image.h"
#include "metrics/overlap/boundary.h"

namespace glint {

/// How far from a simulated edge the real one is looked for, along its normal.
inline constexpr double kInnerReachPx = 8.0;

struct InnerEdges {
  std::vector<Boundary> lines;      ///< where the simulated picture, smoothed, has the level
  std::vector<Boundary> simulated;  ///< located near them in its grey values
  std::vector<Boundary> real;       ///< located near these in the real picture, within the reach
};

/// Edges along the lines on which 3 x 3 means of the simulated picture have a level, and those of
/// the real picture beside them. Lines of less than 20 points are left out.
/// @param simulated  height x width, shares of full scale, as `real` is
/// @param level      grey between bright and dark
/// @param inside     edges elsewhere are left out; of the pictures' size, or empty: nowhere
InnerEdges inner_edges(const ImageF& simulated,
                       const ImageF& real,
                       float level,
                       const Mask& inside = {});

}  // namespace glint
