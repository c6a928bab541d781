// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "simulator/render/path_tracing/path_settings.h"
#include "studies/imaging/built_part.h"
#include "studies/imaging/traced_scene.h"

namespace glint {

/// Where the camera sees the defects: light that they send elsewhere on the part is left out.
/// @param traced   the flawless part under this camera
/// @param blur_px  by which a point's light spreads on the picture
std::vector<PixelWindow> defect_windows(const BuiltDefects& part,
                                        const TracedScene& traced,
                                        const PinholeCamera& camera,
                                        double blur_px);

}  // namespace glint
