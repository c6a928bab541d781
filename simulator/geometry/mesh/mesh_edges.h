// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// An edge between two triangles with the direction it has in each. Triangles a < b.
struct MeshEdge {
  std::int32_t from = 0;  ///< vertices, from < to
  std::int32_t to = 0;
  std::int32_t num_faces = 0;    ///< 1 open, 2 manifold, more non-manifold
  std::int32_t triangle_a = -1;  ///< first two triangles; b = -1 for an open edge
  std::int32_t triangle_b = -1;
  bool is_consistent = false;  ///< two faces that run through it in opposite directions
};

/// Every edge once, ordered by (from, to).
std::vector<MeshEdge> mesh_edges(const TriangleMesh& mesh);

}  // namespace glint
