// SPDX-License-Identifier: GPL-3.0-or-later
//
// Four triangles of one, all over a mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"
#include "simulator/geometry/part/exact_surface.h"

namespace glint {

struct Subdivided {
  TriangleMesh mesh;  ///< faces 4 i to 4 i + 3 come from face i, the last is its core
  std::vector<std::int32_t> labels;  ///< of the face each comes from
  std::vector<std::int32_t> origin;  ///< its number
};

/// One step that keeps the shape: new vertices in the middle of the edges, or on the exact surfaces
/// of the faces there. Shading normals, where the mesh has them, are kept and interpolated. Cost:
/// linear.
/// @param labels  one a face
/// @throws ConfigError when there would be more than 700 million triangles
Subdivided subdivide_midpoint(const TriangleMesh& mesh,
                              std::span<const std::int32_t> labels,
                              std::span<const ExactPatch> patches);

/// Where Loop's rule puts the vertices of subdivide_midpoint(mesh): a smooth surface that the mesh
/// is the control net of. Edges that are open, not manifold, sharper than crease_rad or between
/// faces of different labels stay edges (weights 1/8, 6/8, 1/8 and 1/2, 1/2); a vertex where three
/// or more such edges meet stays. Vertices of exact faces stay: these are smooth as they are.
///
/// Sources: C. Loop, "Smooth subdivision surfaces based on triangles", University of Utah, 1987;
/// H. Hoppe et al., "Piecewise smooth surface reconstruction", SIGGRAPH 1994 (edges; without its
/// special rules for the edge points beside corners).
std::vector<Eigen::Vector3d> loop_places(const TriangleMesh& mesh,
                                         std::span<const std::int32_t> labels,
                                         const Subdivided& midpoint,
                                         double crease_rad);

}  // namespace glint
