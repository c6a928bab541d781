// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "defects/boolean/corefine.h"
#include "defects/boolean/imprint.h"
#include "defects/boolean/imprint_state.h"
#include "defects/boolean/patch_crossings.h"
#include "defects/boolean/patch_pieces.h"
#include "defects/boolean/patch_ring.h"
#include "defects/boolean/patch_tool.h"

namespace glint {

/// Surfaces that are cut and sorted.
struct CutSurfaces {
  const Patch& patch;
  const PatchTool& tool;
  const RingPair& rings;
  const CorefinedPair& cut;
  const Seam& seam;
  Pieces& part_pieces;
  Pieces& tool_pieces;
};

/// The new surface between the borders of what is removed.
struct NewSurface {
  std::vector<std::int32_t> removed;        ///< indices into the patch
  std::vector<std::uint8_t> is_removed;     ///< per face of the patch
  std::vector<std::int32_t> split_parents;  ///< indices into the patch: removed, but pieces remain
  std::vector<Eigen::Vector3d> vertices_mm;
  std::vector<AddedFace> faces;
  std::vector<TestFace> tests;       ///< of faces
  std::vector<std::uint8_t> is_cut;  ///< per face: new, not a whole face of the tool
  std::vector<std::int32_t>
      parent;  ///< per face: index into the patch of what it is a piece of, or -1
  std::size_t num_tool_faces = 0;
  std::size_t num_swallowed = 0;  ///< pieces of part faces that lie inside the tool
  double removed_volume_mm3 = 0.0;
};

NewSurface assemble(const CutSurfaces& surfaces,
                    const ImprintedMeshState& part,
                    std::int32_t label,
                    ImprintOperation operation);

}  // namespace glint
