// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace glint::test {

/// A plate of 60 x 40 x 2 mm under a camera whose distance is searched for; without an objective.
inline constexpr const char* kCoveredPlate = R"(schema = 1
[part]
shape = "plate"
length_mm = 60
width_mm = 40
thickness_mm = 2
[material]
type = "diffuse"
reflectance = [0.5]
[camera]
width_px = 80
height_px = 60
object_pixel_mm = 1
working_distance_mm = 300
[viewpoints]
source = "sphere"
count = 1
polar_min_deg = 0
polar_max_deg = 0
[lighting.environment]
[render.paths]
samples = 4
[coverage]
points = 4000
has_light = false
[variables]
"viewpoints.radius_mm" = { min = 100, max = 400 }
)";

}  // namespace glint::test
