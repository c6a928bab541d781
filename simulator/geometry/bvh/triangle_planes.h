// SPDX-License-Identifier: GPL-3.0-or-later
//
// The planes of a mesh's triangles, and what they tell of the mesh before any ray is traced.
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// The plane of a triangle: normal . p = offset; the normal is unit, zero for one without area.
struct TrianglePlane {
  double normal_x = 0.0, normal_y = 0.0, normal_z = 0.0;
  double offset_mm = 0.0;
};

std::vector<TrianglePlane> planes_of(const TriangleMesh& mesh);

/// Closed, consistently turned, in one piece without a hole (Euler: V - E + F = 2), and no
/// triangle's neighbour in front of it: the surface of a convex body.
bool is_closed_convex(const TriangleMesh& mesh, const std::vector<TrianglePlane>& planes);

/// 1 for triangles whose shading normals are all their own.
std::vector<std::uint8_t> find_flat_triangles(const TriangleMesh& mesh,
                                              const std::vector<TrianglePlane>& planes);

}  // namespace glint
