// SPDX-License-Identifier: GPL-3.0-or-later
//
// Small scenes for tests of pictures by path tracing.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "studies/imaging/path_picture.h"
#include "studies/imaging/traced_scene.h"
#include "tests/studies/scene_from.h"

namespace glint {

/// A rough plate of 12 mm in a picture of 48 x 32 pixels, without light.
inline const std::string kPathView = R"(
[part]
shape = "plate"
length_mm = 12
width_mm = 8
thickness_mm = 1
[material]
type = "conductor"
roughness = 0.5
[camera]
width_px = 48
height_px = 32
object_pixel_mm = 0.2
working_distance_mm = 100
)";

/// The same with a dent and without noise of the sensor.
inline const std::string kPathPlate = kPathView + R"([sensor]
bits = 0
[metrics]
erosion_px = 1
[render.paths]
samples = 8
batches = 4
max_reflections = 2
[defects.dent]
x_mm = [1]
y_mm = [0]
height_um = 60
diameter_mm = 1.6
)";

inline const std::string kPathRing = R"(
[lighting.ring]
inner_radius_mm = 15
outer_radius_mm = 25
height_mm = 30
)";

inline const std::string kPathBar = R"(
[lighting.left]
type = "bar"
position_mm = [-20, 0, 40]
direction = [20, 0, -40]
length_mm = 20
width_mm = 10
)";

inline SceneSettings path_scene(const std::string& lights = kPathRing + kPathBar) {
  return test::scene_from(kPathPlate + lights);
}

/// Largest difference as a share of the second picture's largest value.
inline double largest_difference(const ImageF& a, const ImageF& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0.0;
  double scale = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto value = static_cast<double>(b.values()[i]);
    largest = std::max(largest, std::abs(static_cast<double>(a.values()[i]) - value));
    scale = std::max(scale, std::abs(value));
  }
  return largest / scale;
}

}  // namespace glint
