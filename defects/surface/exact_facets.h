// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "defects/boolean/imprint.h"
#include "simulator/geometry/part/exact_surface.h"

namespace glint {

/// Facets that one tool may ask for, by an estimate.
inline constexpr int kMaxFacetsUnderTool = 500'000;

/// Makes the facets that a tool meets or covers finer, until none is further than tolerance_mm off
/// the exact surface that it stands for: without this, a dent that is no deeper than the facets
/// are off the surface loses its rim. New vertices lie on the exact surface; free faces keep their
/// shape. docs/theory/imprint.md, "Facets under a tool". Cost: as the number of facets there, by a
/// logarithm that of the part's.
/// @param part          closed where the tool is
/// @param tool          closed, in the part's frame
/// @param tolerance_mm  > 0
/// @return false, and the part as it was, when more than kMaxFacetsUnderTool are needed
bool refine_under_tool(ImprintedMesh& part,
                       const TriangleMesh& tool,
                       std::span<const ExactPatch> patches,
                       double tolerance_mm);

}  // namespace glint
