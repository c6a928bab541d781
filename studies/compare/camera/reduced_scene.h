// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scene in fewer pixels, whose grey values are compared with a reduced photograph.
#pragma once

#include "core/image/image.h"
#include "simulator/render/path_tracing/film.h"
#include "studies/definition/scene.h"

namespace glint {

/// The same field of view, without noise and rounding, path traced with as many samples in every
/// pixel and in two batches, so that two independent pictures can be taken from one.
/// @param factor         pixels of the scene to one of the reduced scene, >= 1; what is left over
///                       at the right and bottom is cut off, as reduce() does
/// @param min_samples    of a pixel; more where the scene has more
SceneSettings reduced_scene(const SceneSettings& scene, int factor, int min_samples);

/// Pixels that see the part alone and none of its defects, and lie further than `margin_px` from
/// all others.
Mask sound_part(const Film& sums, int margin_px);

}  // namespace glint
