// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the edges of a region are by the grey values of a picture: boundary points moved along
// their normals. Formulas and accuracy: docs/theory/comparison.md.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/image/image.h"
#include "metrics/overlap/boundary.h"

namespace glint {

struct EdgeSearch {
  double reach_px = 4.0;       ///< edges are looked for this far along the normal, > 1
  double min_contrast = 0.02;  ///< between both sides, in units of the picture, > 0
  double along_px = 1.0;       ///< profiles are means over +- so many pixels along the edge, >= 0
};

/// An edge that was found in grey values.
struct LocatedEdge {
  std::size_t boundary = 0;  ///< index of the boundary and of the point where the search began
  std::size_t point = 0;
  BoundaryPoint edge;      ///< at the edge, with the normal of the search
  double moved_px = 0.0;   ///< along the normal, from where the search began
  double contrast = 0.0;   ///< grey behind minus grey ahead of the edge along the normal
  double sigma_px = 0.0;   ///< of moved_px, by the scatter between neighbouring lines
  double spread_px = 0.0;  ///< standard deviation of the blur of the edge

  /// Where the search began: orders edges, and pairs those of two pictures along one outline.
  std::pair<std::size_t, std::size_t> start() const { return {boundary, point}; }
};

/// Locates the edge near each boundary point by a least-squares fit of a blurred step (an error
/// function with free place, width and both greys) to the profile along the normal. The place is
/// right for any symmetric blur. Points with too little contrast, an edge beyond the reach or a
/// profile that is no step are left out. Cost: some microseconds a point.
std::vector<LocatedEdge> locate_edges(const ImageF& picture,
                                      std::span<const Boundary> boundaries,
                                      const EdgeSearch& search = {});

/// Located edges as boundaries: broken where points were left out or neighbours jumped apart; what
/// has fewer than five points is left out.
std::vector<Boundary> joined(std::span<const LocatedEdge> edges,
                             std::span<const Boundary> boundaries);

}  // namespace glint
