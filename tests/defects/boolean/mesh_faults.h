// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "defects/boolean/patch_crossings.h"
#include "defects/boolean/patch_edges.h"
#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// Faults of a whole mesh, found with exact predicates.
struct MeshFaults {
  std::int64_t open_edges = 0;      ///< directed edges without their opposite
  std::int64_t repeated_edges = 0;  ///< directed edges that belong to more than one face
  std::int64_t crossing_pairs = 0;  ///< pairs of faces that meet in more than shared corners
  std::int64_t degenerate = 0;      ///< faces without area

  bool none() const {
    return open_edges == 0 && repeated_edges == 0 && crossing_pairs == 0 && degenerate == 0;
  }
};

/// mesh: vertices are joined by index; weld() first where equal points have several indices.
inline MeshFaults find_faults(const TriangleMesh& mesh) {
  const EdgeMatches edges = match_edges(mesh.triangles);
  MeshFaults faults = {.open_edges = edges.open, .repeated_edges = edges.repeated};
  std::vector<TestFace> faces;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    faces.emplace_back(mesh.triangles[i],
                       Corners{mesh.vertex(i, 0), mesh.vertex(i, 1), mesh.vertex(i, 2)});
    faults.degenerate += is_degenerate(faces.back()) ? 1 : 0;
  }
  faults.crossing_pairs = count_crossings(faces, std::numeric_limits<std::int64_t>::max());
  return faults;
}

}  // namespace glint
