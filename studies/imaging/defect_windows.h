// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
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

/// How wide a defect looks where it is narrowest, [px]: the diameter of a round one, the width of a
/// line, foreshortened; 0 where the camera does not see that way.
double narrowest_px(const HeightFeature& outline,
                    const PinholeCamera& camera,
                    const RigidTransform& camera_from_world);

/// Defects that are too narrow to be scored well, as a sentence; empty when there are none.
std::string narrow_defects_note(const TracedScene& traced, const SceneSettings& scene);

/// Defects so strongly curved that a period of the tunnel's stripes in them is less than
/// kFinestPeriod_px, in a picture that is blurred: pixels alias such stripes, and the blur, which a
/// lens makes before the pixels, comes after them here. As a sentence; empty when there are none.
std::string defect_stripes_note(const TracedScene& traced, const SceneSettings& scene);

/// In the middle of a defect. The change of a dent is off by 4 % at 0.4 px, by 6 % below 0.2 px.
inline constexpr double kFinestPeriod_px = 0.5;

}  // namespace glint
