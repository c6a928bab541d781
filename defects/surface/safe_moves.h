// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::defects::surface: vertices moved without the mesh crossing itself.
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// Moves every vertex by as much of its move as the mesh bears: where a face would turn by more
/// than 84 degrees, lose its area or cross another one, the moves of its vertices are halved until
/// none does, and at last undone. What was wrong with the mesh before stays as it is.
/// @param moves_mm  one a vertex
/// @return how many vertices moved less than asked
std::int64_t move_safely(TriangleMesh& mesh, std::vector<Eigen::Vector3d> moves_mm);

/// No move longer than `share` of the smallest height of the triangles around its vertex. With a
/// share below 1/3 no triangle can turn over.
/// @return how many moves were shortened
std::int64_t limit_to_heights(const TriangleMesh& mesh,
                              double share,
                              std::vector<Eigen::Vector3d>& moves_mm);

}  // namespace glint
