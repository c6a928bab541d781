// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/image/image.h"
#include "core/thread_pool.h"

namespace glint {

/// How much a picture varies along the direction in which it varies least: the root of the smaller
/// eigenvalue of the structure tensor of its logarithm. Grooves, edges and reflections vary along
/// one direction and give 0; pits, dirt and corners vary along two. docs/theory/inspection.md
/// @param picture   shares of full scale
/// @param mask      of its size; what lies outside is not seen
/// @param width_px  > 0; 4 sigma of the Gaussian window over which the tensor is averaged
/// @return relative change of the grey value per pixel, root of the mean square; negative where the
///         window is darker than its surroundings, 0 outside the mask
ImageF structure_of(const ImageF& picture, const Mask& mask, double width_px, ThreadPool& pool);

}  // namespace glint
