// SPDX-License-Identifier: GPL-3.0-or-later
//
// Defects as height on the surface: Gaussian dents and bumps, and line scratches. They act on the
// normal, and on the position where wanted: for defects much smaller than the viewing distance the
// normal is what matters (docs/theory/parts.md). Stains have no height: they reflect less and are
// rough.
#pragma once

#include "defects/definition/defect.h"

namespace glint {

/// The defect as a height feature: what it does to the normal, and where its pixels are.
/// @param group  for what does not vary between its defects
HeightFeature height_feature(const Defect& defect, const DefectGroup& group);

}  // namespace glint
