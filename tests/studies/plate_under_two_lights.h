// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scene that a tunnel or a ring may light: a mirror by closed forms or a plate by path tracing.
#pragma once

namespace glint::test {

/// 48 x 32 pixels of 0.2 mm; [variables] with lighting_use are to follow.
inline constexpr const char* kPlateUnderTwoLights = R"(schema = 1
[part]
shape = "plate"
length_mm = 12
width_mm = 8
thickness_mm = 1
[camera]
width_px = 48
height_px = 32
object_pixel_mm = 0.2
working_distance_mm = 100
[render.paths]
samples = 16
max_reflections = 1
[lighting.tunnel]
radius_mm = 60
length_mm = 300
slot_mm = 8
[lighting.ring]
inner_radius_mm = 15
outer_radius_mm = 25
height_mm = 30
)";

}  // namespace glint::test
