// SPDX-License-Identifier: GPL-3.0-or-later
//
// The only door to CGAL: corefinement of two small surfaces and exact predicates, on plain arrays.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// A surface, maybe open; every edge has at most two faces and every vertex one fan of faces.
struct PlainMesh {
  std::vector<Eigen::Vector3d> points_mm;
  std::vector<Triangle> faces;
};

struct CorefinedMesh {
  std::vector<Eigen::Vector3d> points_mm;  ///< the input's points first
  std::vector<Triangle> faces;
  std::vector<std::int32_t> parent;    ///< per face, the input's face it is (a piece of)
  std::vector<std::int32_t> opposite;  ///< per corner, as EdgeMatches::opposite
  std::vector<std::uint8_t> is_seam;   ///< per corner: the edge from it lies on both surfaces
};

struct CorefinedPair {
  bool is_done = false;  ///< false: one of the surfaces is not what corefinement needs
  CorefinedMesh first;
  CorefinedMesh second;
};

/// Splits the faces of two surfaces along their intersection, so that its edges are edges of both;
/// points of the intersection have the same coordinates in both. Neither surface may cross itself.
///
/// Source: CGAL 5.5, Polygon Mesh Processing, corefine().
CorefinedPair corefine(const PlainMesh& first, const PlainMesh& second);

using Corners = std::array<Eigen::Vector3d, 3>;

/// Exactly: +1 when d lies on the side of the plane a, b, c from which they turn counter-clockwise,
/// -1 on the other one, 0 in the plane.
int exact_orientation(const Eigen::Vector3d& a,
                      const Eigen::Vector3d& b,
                      const Eigen::Vector3d& c,
                      const Eigen::Vector3d& d);

/// Exactly: do the three points lie on one line?
bool are_collinear(const Corners& corners);

/// Exactly: do two triangles without equal corners have a point in common?
bool triangles_intersect(const Corners& a, const Corners& b);

/// Exactly: do two triangles with equal corners a[0] = b[0] have more in common than that?
bool triangles_cross_at_corner(const Corners& a, const Corners& b);

/// Exactly: do two triangles with a[0] = b[0], a[1] = b[1] have more in common than that edge?
bool triangles_cross_at_edge(const Corners& a, const Corners& b);

}  // namespace glint
