// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light of a Lambertian rectangle on a matt surface, in closed form.
// Source: J. H. Lambert, Photometria, 1760: the irradiance by a polygon of radiance L is
// L / 2 times the sum over its edges of the angle that the edge subtends times the cosine between
// the normal and the plane of the edge; e.g. Baum, Rushmeier, Winget, SIGGRAPH 1989, eq. 9.
#pragma once

#include <array>

#include <Eigen/Core>

namespace glint::stability {

/// Irradiance at a place, of a rectangle all above the horizon.
/// @param corners_mm  in order around it
/// @param normal      unit
/// @param radiance    of the rectangle, the same everywhere
double polygon_irradiance(const std::array<Eigen::Vector3d, 4>& corners_mm,
                          const Eigen::Vector3d& place_mm,
                          const Eigen::Vector3d& normal,
                          double radiance);

}  // namespace glint::stability
