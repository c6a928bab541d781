// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// Corners as indices into a list of points; outer polygons run counter-clockwise.
using Polygon = std::vector<std::int32_t>;

/// Twice the signed area.
double doubled_area(const std::vector<Eigen::Vector2d>& points, const Polygon& polygon);

bool is_inside(const std::vector<Eigen::Vector2d>& points,
               const Polygon& polygon,
               const Eigen::Vector2d& point);

/// Triangles that fill a simple polygon with holes, without new points, appended to `triangles`.
/// Neighbouring edges of the polygon may be in line. False when rounding makes it impossible.
///
/// Source: ear clipping, holes joined by bridges: D. Eberly, "Triangulation by ear clipping",
/// Geometric Tools, 2002; here the ear of the best shape goes first.
bool triangulate(const std::vector<Eigen::Vector2d>& points,
                 const Polygon& outer,
                 const std::vector<Polygon>& holes,
                 std::vector<Triangle>& triangles);

}  // namespace glint
