// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// Directions in which rays that have left a part never meet it again, wherever they start.
///
/// From outside a closed part a ray can only meet triangles that face it. Triangles that nothing
/// rises above face no ray from the part. So a ray from the part that looks along the outward
/// normals of all others (n . d > 0) meets nothing: that of a shallow bowl, for example.
///
/// And whatever the part, a ray that leaves the front of a triangle that nothing rises above meets
/// nothing: the tips of a gear's teeth.
struct EscapeCone {
  bool is_empty = true;            ///< no such direction is known for rays from everywhere
  std::array<double, 3> low = {};  ///< of the components of those normals
  std::array<double, 3> high = {};
  /// 1 for triangles that nothing rises above by more than 1e-7 mm, of which some may be
  /// overlooked. Without numbers when there are none.
  std::vector<std::uint8_t> is_open;
};

/// No directions for an open mesh, for one of more than 200,000 triangles, and for most parts:
/// their triangles look into all directions.
EscapeCone find_escape_cone(const TriangleMesh& mesh);

}  // namespace glint
