// SPDX-License-Identifier: GPL-3.0-or-later
//
// The faces of part and tool that meet each other: only they need the Boolean operation.
#pragma once

#include <utility>

#include "defects/boolean/corefine.h"
#include "defects/boolean/imprint_state.h"
#include "defects/boolean/patch_tool.h"

namespace glint {

/// The part's faces near a tool.
struct Patch {
  Patch(const ImprintedMeshState& part, const PatchTool& tool);

  std::vector<std::int32_t> faces;  ///< ascending
  std::vector<TestFace> tests;
  std::vector<Triangle> triangles;
  EdgeMatches edges;
};

/// Faces of one surface that meet the other one, as a mesh of its own. Its border does not meet the
/// other surface, unless it is a border of the surface itself.
struct Ring {
  std::vector<std::int32_t> faces;       ///< of the patch or tool, ascending
  PlainMesh mesh;                        ///< faces in the same order
  std::vector<std::int32_t> vertex_ids;  ///< per point of mesh, its index in the surface
};

struct RingPair {
  Ring part;
  Ring tool;
  /// Faces of both that may meet, by their places in the rings.
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
};

RingPair find_rings(const Patch& patch, const PatchTool& tool);

/// Has the ring a face without area, or two that cross?
bool is_broken(const Ring& ring, std::span<const TestFace> surface);

}  // namespace glint
