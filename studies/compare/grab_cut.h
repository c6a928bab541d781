// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/image/image.h"

namespace glint {

/// The part in a picture whose place is roughly known, by colours' mixtures on both sides of a cut
/// (C. Rother et al., "GrabCut", SIGGRAPH 2004; OpenCV's). Grey values from 0 to the picture's own
/// maximum.
/// @param rough  where the part should be: sure inside after shrinking, sure outside after growing
///               it by a tenth of its size
/// @returns nothing where one side is empty
std::optional<Mask> grab_cut(const ImageF& picture, const Mask& rough);

}  // namespace glint
