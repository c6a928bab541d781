// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the rays of a picture meet the wall, tile by tile: smooth tiles by their nodes, the rest
// ray by ray (docs/theory/footprints.md).
#pragma once

#include <vector>

#include "simulator/render/corner_rays/sparse_rays.h"
#include "simulator/render/wall/wall_hits.h"

namespace glint {

/// Where all hits of a tile and of its lower and right neighbours' nearest rays lie.
struct TileLimits {
  enum Kind : unsigned char {
    kUnknown,
    kKnown,
    kNoRays  ///< the tile has none
  };

  int columns = 0;  ///< of tiles; 0: nothing is known
  int rows = 0;
  std::vector<Kind> kind;  ///< row by row; limits are those of kKnown
  std::vector<float> x_low_mm, x_high_mm, y_low_mm, y_high_mm, margin_low_mm, margin_high_mm;
  std::vector<float> stripes_low_mm, stripes_high_mm;  ///< empty: those of x
};

/// intersect_light() of all lit corners, dark ones meet nothing: to 1/100 of what a pixel sees of
/// the wall (or 0.001 mm) the same along the stripes' order, across the tunnel to 1/200, and to
/// five times that where no boundary of the light is near: checked at two places of each tile,
/// which else is intersected ray by ray.
/// @param sparse  of these corners, not empty
/// @param limits  what is known of the tiles; set
WallHits intersect_sparse(const SparseRays& sparse,
                          const RayCache& corners,
                          const Tunnel& tunnel,
                          TileLimits& limits);

}  // namespace glint
