// SPDX-License-Identifier: GPL-3.0-or-later
//
// Flat facets that stand for a cylinder or a cone: meshes of turned parts have them.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "studies/compare/surface/surface_shape.h"

namespace glint {

/// A flat piece of a surface, by some of its points.
struct FlatPiece {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();    ///< unit, away from the material
  Eigen::Vector3d middle_mm = Eigen::Vector3d::Zero();  ///< a point of its plane
  std::vector<Eigen::Vector3d> points_mm;               ///< that show its extent
};

/// The cylinder or cone that facets touch: with the axis' direction a, and n' the part of a normal
/// n that is square to it, n . p = n' . c + t for all points p of all facets, where n . a is one
/// for all; c is a point of the axis, t the distance of the planes from it.
struct RoundShape {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();
  double distance_mm = 0.0;  ///< < 0 of a bore
  double along = 0.0;        ///< of the normals along the axis
  double step_rad = 0.0;     ///< from one facet to the next, > 0

  double radius_mm() const;

  /// Whether some surface is of this shape, its facets not told apart.
  /// @param pixel_mm  by which its tangent planes may miss the shape (rms), beside 2 % of its
  /// radius
  bool holds(std::span<const PointWithNormal> points, double pixel_mm) const;
};

/// Pieces that are facets of one round surface.
struct FacetFan {
  std::vector<std::size_t> pieces;  ///< indices, ascending
  RoundShape shape;
};

/// Beyond it neighbours are sides of a prism: 12 facets around have 30 degrees, 10 have 36.
inline constexpr double kMaxFacetStep_rad = 0.5585;  // 32 deg

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
