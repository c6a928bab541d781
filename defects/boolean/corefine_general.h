// SPDX-License-Identifier: GPL-3.0-or-later
//
// Corefinement for the usual case, several times faster than the general one: no corner of one
// surface lies on the other, no edges meet. Exact signs decide what crosses what; only the places
// of the crossings are rounded.
#pragma once

#include <optional>
#include <utility>

#include "defects/boolean/corefine.h"
#include "defects/boolean/patch_crossings.h"

namespace glint {

/// A surface with its faces ready for tests; tests[i].corners are those of mesh.faces[i].
struct GeneralSurface {
  const PlainMesh& mesh;
  std::vector<TestFace> tests;
};

/// Like corefine(). pairs: all faces of both that may meet. Empty when a sign is zero, a seam ends
/// inside a face, or rounding gets in the way: corefine() then knows better.
std::optional<CorefinedPair> corefine_general(
    const GeneralSurface& first,
    const GeneralSurface& second,
    const std::vector<std::pair<std::int32_t, std::int32_t>>& pairs);

}  // namespace glint
