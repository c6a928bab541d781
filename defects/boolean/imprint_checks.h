// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// Why the mesh cannot be a tool, as a sentence; empty when it is closed, turned outwards, has no
/// face without area and does not cross itself.
std::string tool_fault(const TriangleMesh& tool);

/// Faults of a whole mesh, found with exact predicates. Linear in the number of faces.
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
MeshFaults find_faults(const TriangleMesh& mesh);

}  // namespace glint
