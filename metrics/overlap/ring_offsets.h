// SPDX-License-Identifier: GPL-3.0-or-later
//
// Offsets of edges against the distance from the middle of the picture: what is left when a lens is
// modelled wrongly grows outwards. Formulas: docs/theory/comparison.md.
#pragma once

#include <optional>
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
  /// picture taken out; interval of 95 %: neighbouring edges are resampled together. Empty: fewer
  /// than 96 edges, or nearly at one radius, as those of a round part in the picture's middle. The
  /// noise of such an edge is in its radius and, negated, in its offset, which by itself would make
  /// a slope of nearly -1000 px over 1000 px.
  std::optional<Estimate> radial_slope;
  std::optional<Estimate> tangential_slope;
};

/// @param offsets    in the order of their boundaries: neighbours stand beside each other
/// @param centre_px  from which radii are measured
/// @param num_rings  >= 1, of equal width up to the farthest edge
RingOffsets ring_offsets(std::span<const EdgeOffset> offsets,
                         const Eigen::Vector2d& centre_px,
                         int num_rings = 8);

}  // namespace glint
