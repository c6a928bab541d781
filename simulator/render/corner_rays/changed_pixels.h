// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/image/image.h"
#include "simulator/render/corner_rays/corner_rays.h"

namespace glint {

/// 1 where a pixel's rays differ between two pictures by the same camera: what another set of
/// defects changes. Exact: equal rays are equal bit for bit.
Mask changed_pixels(const CornerRays& before, const CornerRays& after);

}  // namespace glint
