// SPDX-License-Identifier: GPL-3.0-or-later
//
// Defects as a fine mesh that is really moved: a height along the normal of the smooth surface,
// for defects that are too deep for a tilt of the normal alone and too shallow to need a Boolean
// operation (docs/theory/imprint.md).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"
#include "simulator/geometry/part/exact_surface.h"
#include "simulator/geometry/surface/surface_detail.h"

namespace glint {

/// What became of one height feature.
struct DisplacedFeature {
  int id = 0;
  double removed_volume_mm3 = 0.0;  ///< negative where material was added
  int faces = 0;                    ///< that carry its id
};

struct Displaced {
  TriangleMesh mesh;                 ///< faces that were moved are free, with analytic normals
  std::vector<std::int32_t> labels;  ///< per face: a feature's id within its radius, else as before
  std::vector<std::int32_t> origin;  ///< per face: the face of the input that it is a piece of
  std::vector<DisplacedFeature> features;  ///< as many as were given, in their order
  double removed_volume_mm3 = 0.0;         ///< of all; what enclosed volume the moves take away
};

/// Moves the surface by the sum of the heights, as SurfaceDetail gives it: along the normal of the
/// exact surface, or the shading normal of a free face. Faces within 5 sigma of a feature are cut
/// until no edge is longer than sigma / edges_per_sigma (coarser beyond 2 sigma, where less bends),
/// new vertices of exact faces lie on the exact surface. The corner normals of moved faces are
/// those of the smooth surface tilted by the height's gradient. A closed mesh stays closed; faces
/// that no feature reaches and that are not cut with their neighbours keep their place and their
/// bytes. Where features overlap, a face's share of the volume goes to the feature that is nearest
/// in radii. Features without height are left out. Cost: one copy and two passes over the mesh,
/// then only the faces near features.
/// @param mesh      with shading normals
/// @param labels    one a face
/// @param patches   what mesh.patch points to
/// @param features  ids differ from each other, > 0
/// @throws ConfigError naming the feature: sizes not positive, or more than 20 million triangles
Displaced displace(TriangleMesh mesh,
                   std::vector<std::int32_t> labels,
                   std::span<const ExactPatch> patches,
                   std::span<const HeightFeature> features,
                   double edges_per_sigma = 8.0);

}  // namespace glint
