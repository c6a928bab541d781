// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace glint::test {

/// Two designs: a ring or a bar above a plate with a dent, in pictures of 120 x 90 pixels.
inline constexpr const char* kRingOrBar = R"(schema = 2
[part]
shape = "plate"
length_mm = 16
width_mm = 12
[material]
type = "conductor"
roughness = 0.3
[camera]
width_px = 120
height_px = 90
object_pixel_mm = 0.2
working_distance_mm = 100
[sensor]
exposure = 0.5
bits = 12
full_well_e = 10000
[render.paths]
samples = 32
max_reflections = 1
[lighting.ring]
mount = "camera"
segments = 4
[lighting.bar]
position_mm = [0, 60, 60]
direction = [0, -1, -1]
[defects.dent]
diameter_mm = 3
height_um = 100
[prototypes.ring]
"lighting.bar.radiance" = [0]
[prototypes.bar]
"lighting.ring.radiance" = [0]
)";

}  // namespace glint::test
