// SPDX-License-Identifier: GPL-3.0-or-later
//
// Geometry processing of a finished part: subdivision, noise on vertices and edges, noise on the
// normals of faces (docs/theory/imprint.md).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "defects/definition/defect_settings.h"
#include "simulator/geometry/mesh/triangle_mesh.h"
#include "simulator/geometry/part/exact_surface.h"

namespace glint {

struct Processed {
  TriangleMesh mesh;                  ///< with shading normals; faces that changed are free
  std::vector<std::int32_t> labels;   ///< of the faces they come from
  std::vector<std::int32_t> origin;   ///< number of the input's face each comes from
  std::int64_t limited_vertices = 0;  ///< moved less than drawn, so that the surface stays whole
};

/// True when processing would change a mesh.
bool is_any(const ProcessingSettings& settings);

/// Applies, in this order:
///  - subdivision, `levels` times;
///  - vertex noise: every vertex moves along its normal by a Gaussian number; edge roughness: the
///    same for vertices on sharp edges (faces at more than crease_rad, and open edges), in
///    addition;
///  - face-normal noise: the three shading normals of a face are turned together by a random tilt
///    in a random direction, whose two components are Gaussian with rms / sqrt 2 each. Each face
///    then has its own normals.
/// Faces whose vertices or normals change no longer stand for an exact surface. No vertex moves by
/// more than 0.3 of the smallest height of its triangles, and moves after which faces would cross
/// (exact predicates) are shortened, so a mesh that does not cross itself comes out as one.
/// The same bytes for the same seed: noise depends on the seed and the number of vertex or face.
/// @param labels  one a face
Processed apply_processing(const ProcessingSettings& settings,
                           std::uint64_t seed,
                           TriangleMesh mesh,
                           std::vector<std::int32_t> labels,
                           std::span<const ExactPatch> patches,
                           double crease_rad);

}  // namespace glint
