// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scene in fewer pixels, as half resolution renders it.
#pragma once

#include "studies/definition/scene.h"

namespace glint {

/// The scene with pixels `factor` times as large along both sides, and as many fewer; blur and
/// erosion shrink with them. @param factor  >= 1
SceneSettings with_larger_pixels(SceneSettings scene, int factor);

}  // namespace glint
