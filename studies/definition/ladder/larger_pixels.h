// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scene in fewer pixels, as half resolution renders it.
#pragma once

#include "studies/definition/scene.h"

namespace glint {

/// The scene with pixels `factor` times as large along both sides, and as many fewer. Lengths and
/// areas in pixels of [sensor], [metrics], [inspection] and [coverage] shrink with them, so that
/// they stay the same on the part; whole numbers are rounded up. [reference] stays: its pictures
/// have their own pixels. @param factor  >= 1
SceneSettings with_larger_pixels(SceneSettings scene, int factor);

}  // namespace glint
