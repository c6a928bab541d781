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
/// gives equal bytes. The axis across is called x or y, or horizontal where it is neither. Sizes of
/// rings, domes and bars have dimension lines (light_dimensions.h); below stand the lights in words
/// and the scale, a usual one when the sheet is printed at 100 %, on A4.
std::string area_lights_svg(const SceneSettings& scene,
                            const PhysicalScene& physical,
                            const std::string& title);

/// The same lines at 1 : 1 as DXF, in mm: layers LIGHT, PART, CAMERA (its axis) and NOTES (title,
/// axes and the lights in words).
std::string area_lights_dxf(const SceneSettings& scene,
                            const PhysicalScene& physical,
                            const std::string& title);

}  // namespace glint
