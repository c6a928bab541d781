// SPDX-License-Identifier: GPL-3.0-or-later
//
// Connected pixels of one surface, and those that are facets of one round surface joined. Private
// to the room.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/image/image.h"
#include "studies/compare/surface/facet_fans.h"
#include "studies/compare/surface/simulated_surface.h"
#include "studies/compare/surface/surface_shape.h"

namespace glint::compare_detail {

struct Piece {
  std::vector<std::pair<int, int>> pixels;         ///< x, y; at least one
  std::optional<RoundShape> shape = std::nullopt;  ///< of the facets that it is made of
};

/// Whether each of two points lies beyond the other's tangent plane: by more than 1.5 pixels and
/// 0.35 of their distance.
bool is_step(const Eigen::Vector3d& step,
             const Eigen::Vector3d& first,
             const Eigen::Vector3d& second,
             double pixel_mm);

/// About so many of its points.
std::vector<PointWithNormal> points_of(const SimulatedSurface& surface,
                                       const Piece& piece,
                                       std::size_t about);

/// The largest of its pixels. @param focal_px  pixels per radian
double pixel_of(const SimulatedSurface& surface, const Piece& piece, double focal_px);

/// Facets of a mesh that stand for one cylinder or cone become one piece, and what of it was not
/// told apart into facets goes with them.
/// @param labels  of piece i: i + 1; of what is none: <= 0
std::vector<Piece> joined_facets(const SimulatedSurface& surface,
                                 double focal_px,
                                 const Image<int>& labels,
                                 std::vector<Piece> pieces);

}  // namespace glint::compare_detail
