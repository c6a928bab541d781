// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is known of a place on a mesh: of the hit of a ray, or of a point nearby.
#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// The nearest hit of one ray: point = (1 - u - v) v0 + u v1 + v v2 of the triangle.
struct Hit {
  float t_mm = 0.0F;
  std::int32_t triangle = -1;  ///< < 0: miss
  float u = 0.0F;
  float v = 0.0F;

  explicit operator bool() const { return triangle >= 0; }
};

/// The hit's position in double, from the barycentrics: on the triangle's plane to about 1e-13.
Eigen::Vector3d hit_point(const TriangleMesh& mesh, const Hit& hit);

/// Unit interpolated normal; the mesh must have shading normals.
Eigen::Vector3d shading_normal(const TriangleMesh& mesh, const Hit& hit);

/// The point of a triangle that is nearest to another; triangles without area are fine.
Eigen::Vector3d nearest_on_triangle(const TriangleMesh& mesh,
                                    std::size_t triangle,
                                    const Eigen::Vector3d& point_mm);

/// Unit normal of the triangle that was hit.
Eigen::Vector3d geometric_normal(const TriangleMesh& mesh, const Hit& hit);

}  // namespace glint
