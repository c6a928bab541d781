// SPDX-License-Identifier: GPL-3.0-or-later
//
// Flat facets that stand for a cylinder or a cone: meshes of turned parts have them.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace glint {

/// A flat piece of a surface, by some of its points.
struct FlatPiece {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();    ///< unit, away from the material
  Eigen::Vector3d middle_mm = Eigen::Vector3d::Zero();  ///< a point of its plane
  std::vector<Eigen::Vector3d> points_mm;               ///< that show its extent
};

/// Pieces that are facets of one round surface.
struct FacetFan {
  std::vector<std::size_t> pieces;  ///< indices, ascending
  double step_rad = 0.0;            ///< from one facet to the next, > 0
};

/// Beyond it neighbours are sides of a prism: 12 facets around have 30 degrees, 10 have 36.
inline constexpr double kMostFacetStep_rad = 0.5585;  // 32 deg

/// Fans of at least four facets: neighbours are turned about one common axis by equal angles (to 1
/// degree) of at most 32 degrees, have one angle to it, and touch one cylinder or cone about it;
/// and none is wider than twice what its angle takes of the circumference, so that the sides of a
/// box beside a chamfer are no facets. Formulas: docs/theory/comparison.md.
/// @param neighbours  pairs of indices that have an edge in common
/// @param pixel_mm    by which planes may miss the round surface, beside 2 % of its radius
/// @returns no piece is in two fans
std::vector<FacetFan> facet_fans(std::span<const FlatPiece> pieces,
                                 std::span<const std::pair<std::size_t, std::size_t>> neighbours,
                                 double pixel_mm);

}  // namespace glint
