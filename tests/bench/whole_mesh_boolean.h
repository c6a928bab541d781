// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// Time [s] of subtracting the tools one by one with CGAL's corefinement on the whole mesh.
double whole_mesh_difference_seconds(const TriangleMesh& part,
                                     const std::vector<TriangleMesh>& tools);

}  // namespace glint
