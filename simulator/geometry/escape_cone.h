// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "simulator/geometry/triangle_mesh.h"

namespace glint {

/// Directions in which rays that have left a part never meet it again, wherever they start.
///
/// From outside a closed part a ray can only meet triangles that face it. Triangles that nothing
/// rises above face no ray from the part. So a ray from the part that looks along the outward
/// normals of all others (n . d > 0) meets nothing: that of a shallow bowl, for example.
struct EscapeCone {
  bool is_empty = true;            ///< no such direction is known
  std::array<double, 3> low = {};  ///< of the components of those normals
  std::array<double, 3> high = {};
};

/// Empty for an open mesh, for one of more than 200,000 triangles, and for most parts: their
/// triangles look into all directions.
EscapeCone find_escape_cone(const TriangleMesh& mesh);

}  // namespace glint
