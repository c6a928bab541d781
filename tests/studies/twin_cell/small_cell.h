// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>

#include "core/file.h"
#include "studies/twin_cell/cell_renderer.h"
#include "tests/support/temporary_folder.h"

namespace glint {

/// A matt plate with a dent under two lights, seen by a camera of 64 x 48 pixels.
inline constexpr const char* kSmallTruth = R"(schema = 1

[part]
shape = "plate"
length_mm = 48
width_mm = 36
thickness_mm = 5

[material]
type = "diffuse"

[camera]
width_px = 64
height_px = 48
object_pixel_mm = 0.5
working_distance_mm = 180

[sensor]
wavelengths_nm = [630]
bits = 8
full_well_e = 10000
read_noise_e = 10
exposure = 0.5

[lighting.ring]
mount = "camera"
inner_radius_mm = 30
outer_radius_mm = 60
height_mm = 80
radiance = [4]

[lighting.bar]
mount = "camera"
position_mm = [0, -100, 80]
direction = [0, 1, 1]
length_mm = 120
width_mm = 25
radiance = [8]

[render.paths]
samples = 4
max_reflections = 1

[truth]
camera_position_mm = [0, 40, 30]
scene_position_mm = [300, 0, 0]
exposure_us = 5000
)";

inline Truth truth_of(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "truth.toml", text);
  return read_truth(folder / "truth.toml");
}

/// The flange so that the camera of kSmallTruth looks straight down on the plate, `aside_mm` from
/// its middle. In the base: the plate at x = 300, the camera 180 mm above it; turned by pi about x.
inline TwinCellState state_above(double aside_mm, std::vector<std::string> lights) {
  TwinCellState state = {.lights = std::move(lights)};
  state.base_from_flange.rotation = Eigen::Vector3d(1, -1, -1).asDiagonal();
  // The camera sits at (0, 40, 30) on the flange: at (0, -40, -30) from it in the base.
  state.base_from_flange.translation_mm = {300 + aside_mm, 40, 180 + 30};
  return state;
}

}  // namespace glint
