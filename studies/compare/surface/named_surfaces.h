// SPDX-License-Identifier: GPL-3.0-or-later
//
// The surfaces of the part that a rendered view shows, told apart by its creases and steps.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/image/image.h"
#include "studies/compare/surface/simulated_surface.h"

namespace glint {

struct NamedSurfaces {
  static constexpr int kBackground = 0;
  static constexpr int kNone = -1;  ///< on the part, but of no surface of a size worth a name

  Image<int> labels;               ///< of each pixel the surface's number from 1, or one of these
  std::vector<std::string> names;  ///< of surface 1, 2, ...: shape_name(), the largest first

  /// The surface at a place of the picture; kBackground beside it.
  int at(const Eigen::Vector2d& at_px) const;

  /// @param label  kNone or kBackground: "background" @returns its name
  const std::string& name_of(int label) const;
};

/// Neighbours are of one surface unless it bends by more than 15 degrees within a radius of eight
/// pixels between them, or by more than 60 degrees, or one lies more than 1.5 pixels above the
/// other's tangent plane. Pieces of less than 100 pixels get no name. Facets of a mesh that stand
/// for a cylinder or cone are one surface (facet_fans.h).
/// @param focal_px  pixels per radian, > 0
NamedSurfaces find_surfaces(const SimulatedSurface& surface, double focal_px);

}  // namespace glint
