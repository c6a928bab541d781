// SPDX-License-Identifier: GPL-3.0-or-later
//
// One imprint, from the tool to the change of the part: find the ring of faces that meet, cut them,
// sort the pieces, put the new surface together, and accept it only when it is valid.
#pragma once

#include <cstdint>

#include "defects/boolean/imprint.h"
#include "defects/boolean/imprint_state.h"
#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// What the tool does to the part; change is to be applied when the outcome is kDone.
struct PatchResult {
  ImprintResult result;
  PatchChange change;
};

PatchResult cut_patch(const ImprintedMeshState& part,
                      const TriangleMesh& tool,
                      std::int32_t label,
                      ImprintOperation operation,
                      const ImprintLimits& limits);

}  // namespace glint
