// SPDX-License-Identifier: GPL-3.0-or-later
//
// A plate of rough metal with a dent under lamps of several kinds, exposed to about half of full
// scale.
#pragma once

#include <string>

#include "tests/studies/scene_from.h"

namespace glint::lamp_test {

inline const std::string kPlate = R"([part]
shape = "plate"
length_mm = 14
width_mm = 10
thickness_mm = 1
[camera]
width_px = 40
height_px = 30
object_pixel_mm = 0.3
working_distance_mm = 100
[sensor]
bits = 0
full_well_e = 0
blur_px = 0
[metrics]
erosion_px = 2
[defects.dent]
x_mm = [2]
y_mm = [1]
height_um = 60
diameter_mm = 2
[render.paths]
samples = 128
max_reflections = 1
batches = 16
)";

inline const std::string kSteel = "[material]\ntype = \"conductor\"\nreflectance = [0.8]\n";
inline const std::string kDirect = "[render]\nmethod = \"direct\"\n";

inline const std::string kRing = R"([lighting.ring]
inner_radius_mm = 15
outer_radius_mm = 25
height_mm = 50
radiance = [1.5]
)";

inline const std::string kDome = R"([lighting.dome]
position_mm = [0, 0, 100]
radius_mm = 60
opening_mm = 30
radiance = [0.6]
)";

inline const std::string kBar = R"([lighting.bar]
position_mm = [-30, 0, 50]
direction = [30, 0, -50]
length_mm = 60
width_mm = 15
radiance = [3]
)";

inline const std::string kOtherBar = R"([lighting.other]
type = "bar"
position_mm = [30, 10, 50]
direction = [-30, 0, -50]
length_mm = 40
width_mm = 10
radiance = [2]
)";

inline SceneSettings lamp_scene(const std::string& lights,
                                const std::string& width = "alpha = [0.2]\n",
                                const std::string& render = kDirect) {
  return test::scene_from(kSteel + width + kPlate + render + lights);
}

inline SceneSettings by_paths(SceneSettings scene) {
  scene.render.method = RenderSettings::Method::kPaths;
  return scene;
}

}  // namespace glint::lamp_test
