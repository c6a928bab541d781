// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a piece of a surface is called by an engineer: a plane, a cylinder, a bore, a sphere.
#pragma once

#include <span>
#include <string>

#include <Eigen/Core>

namespace glint {

/// A point of a surface and the normal there, which points away from the material.
struct PointWithNormal {
  Eigen::Vector3d at_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit
};

/// By least squares of at = centre + radius normal. "plane facing +z at z = 10.0 mm", "plane facing
/// (0.71, 0.00, 0.71)", "cylinder of radius 18.0 mm along z" ("bore" where the material is
/// outside), "sphere of radius 36.0 mm" ("hollow"), "cone about z", "curved surface".
/// @param points    at least one
/// @param pixel_mm   what a shape may leave of them, as an rms, beside 2 % of its radius
/// @param facet_rad  turn between the flat facets that stand for a round surface, in [0, pi / 4];
///                   0: none. "cylinder of radius 18.0 mm along z in facets of 15 deg": the radius
///                   is that of the facets' edges
std::string shape_name(std::span<const PointWithNormal> points,
                       double pixel_mm,
                       double facet_rad = 0.0);

}  // namespace glint
