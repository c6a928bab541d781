// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace glint::test {

/// A plate of rough metal with a dent under a ring, 80 x 60 px in a picture of 120 x 90.
inline constexpr const char* kDentedPlate = R"(schema = 1
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
samples = 64
max_reflections = 1
[lighting.ring]
mount = "camera"
[defects.dent]
diameter_mm = 3
height_um = 100
)";

}  // namespace glint::test
