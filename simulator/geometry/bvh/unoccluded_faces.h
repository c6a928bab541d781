// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// Flat faces of a mesh that nothing rises above: a ray that leaves one outwards meets the mesh no
/// more, so it need not be traced.
struct UnoccludedFaces {
  std::vector<Eigen::Vector3d> normals;   ///< unit, outward, one for each face
  std::vector<std::int32_t> of_triangle;  ///< which face a triangle lies in, -1: none

  bool empty() const { return normals.empty(); }
};

/// Looks at the flat faces that make up most of the area, at most 24 directions; small faces and
/// curved ones count as none.
/// @param tolerance_mm  how far below the highest vertex triangles of a face may lie; rays must
///                      start more than this above them
UnoccludedFaces find_unoccluded_faces(const TriangleMesh& mesh, double tolerance_mm);

}  // namespace glint
