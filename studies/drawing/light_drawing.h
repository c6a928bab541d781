// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "simulator/render/path_tracing/physical_scene.h"
#include "studies/definition/scene.h"

namespace glint {

/// Area lights, part and camera from the side, to scale, as an SVG document of 440 units width: z
/// upwards, across the direction into which the camera looks (looking down: the one in which the
/// lights are set apart, else y). Rings and domes are cut where the plane through the camera meets
/// them, flat lights are seen from the side. A camera far away stands behind a break. Equal input
/// gives equal bytes. The axis across is called x or y, or h where it is neither.
std::string area_lights_svg(const SceneSettings& scene,
                            const PhysicalScene& physical,
                            const std::string& title);

}  // namespace glint
