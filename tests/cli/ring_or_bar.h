// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace glint::test {

/// A plate of rough metal, 80 x 60 px in a picture of 120 x 90, without lights.
inline const std::string kMetalPlate = R"([part]
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
)";

inline const std::string kDent = "[defects.dent]\ndiameter_mm = 3\nheight_um = 100\n";

/// Two designs: a ring or a bar above the plate with a dent.
inline const std::string kRingOrBar = "schema = 2\n" + kMetalPlate + kDent + R"([render.paths]
samples = 32
max_reflections = 1
[lighting.ring]
mount = "camera"
segments = 4
[lighting.bar]
position_mm = [0, 60, 60]
direction = [0, -1, -1]
[prototypes.ring]
"lighting.bar.radiance" = [0]
[prototypes.bar]
"lighting.ring.radiance" = [0]
)";

}  // namespace glint::test
