// SPDX-License-Identifier: GPL-3.0-or-later
//
// Offsets of edges against the distance from the middle of the picture: what is left when a lens is
// modelled wrongly grows outwards. Formulas: docs/theory/comparison.md.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "metrics/statistics/estimate.h"

namespace glint {

/// How far an edge has moved along its normal.
struct EdgeOffset {
  Eigen::Vector2d at_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double offset_px = 0.0;
};

/// A ring of the picture; means by least squares from offsets along normals.
struct OffsetRing {
  double inner_px = 0.0;
  double outer_px = 0.0;
  std::size_t points = 0;
  double radial_px = 0.0;      ///< outwards > 0; 0 where no edge there tells
  double tangential_px = 0.0;  ///< from +x to +y > 0
  bool has_radial = false;
  bool has_tangential = false;
};

struct RingOffsets {
  std::vector<OffsetRing> rings;
  /// Change of the radial and of the tangential offset over 1000 px of radius, common shift of the
  /// picture taken out; interval of 95 %: neighbouring edges are resampled together.
  Estimate radial_slope;
  Estimate tangential_slope;
  bool has_slopes = false;  ///< false: edges at too few places, or at one radius
};

/// @param offsets    in the order of their boundaries: neighbours stand beside each other
/// @param centre_px  from which radii are measured
/// @param num_rings  >= 1, of equal width up to the farthest edge
RingOffsets ring_offsets(std::span<const EdgeOffset> offsets,
                         const Eigen::Vector2d& centre_px,
                         int num_rings = 8);

}  // namespace glint
