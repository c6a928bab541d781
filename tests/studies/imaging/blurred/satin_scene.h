// SPDX-License-Identifier: GPL-3.0-or-later
//
// A bent strip of satin metal under a fringe tunnel, with a dent.
#pragma once

#include <string>

#include "tests/studies/scene_from.h"

namespace glint::satin_test {

inline const std::string kPart = R"([part]
shape = "strip"
length_mm = 46
width_mm = 17
radius_along_mm = 400
radius_across_mm = 60
)";

inline const std::string kMetal = R"([material]
type = "conductor"
reflectance = [0.9]
alpha = [0.05]
)";

inline const std::string kTunnel = R"([lighting.tunnel]
shape = "semicylinder"
radius_mm = 100
length_mm = 600
slot_mm = 10
period_mm = 24
)";

inline const std::string kRest = R"([camera]
width_px = 60
height_px = 26
object_pixel_mm = 0.7
working_distance_mm = 300
[sensor]
bits = 0
full_well_e = 0
blur_px = 0
[scan]
positions = 6
[metrics]
erosion_px = 2
[defects.dent]
x_mm = [6]
y_mm = [3]
height_um = 40
diameter_mm = 3
[render.paths]
samples = 1024
max_reflections = 1
)";

inline const std::string kBlurred = "[render]\nmethod = \"blurred\"\n";

inline SceneSettings satin_scene(const std::string& render = kBlurred) {
  return test::scene_from(kPart + kMetal + kTunnel + kRest + render);
}

}  // namespace glint::satin_test
