// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace glint::test {

/// A bright plate of 12 x 8 mm before black, 96 x 64 pixels of 0.2 mm.
inline constexpr const char* kPhotographedPlate = R"(schema = 2
[part]
shape = "plate"
length_mm = 12
width_mm = 8
thickness_mm = 1
[material]
type = "diffuse"
reflectance = [0.5]
[camera]
width_px = 96
height_px = 64
object_pixel_mm = 0.2
working_distance_mm = 100
[lighting.ring]
inner_radius_mm = 15
outer_radius_mm = 25
height_mm = 30
radiance = [3]
[render.paths]
samples = 16
batches = 1
max_reflections = 1
)";

}  // namespace glint::test
