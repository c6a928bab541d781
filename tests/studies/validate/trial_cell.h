// SPDX-License-Identifier: GPL-3.0-or-later
//
// A small cell whose truth is known: a study with designs, written as the folder of a run, and real
// pictures of them, rendered from another scene.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "studies/definition/scene.h"

namespace glint {

/// A plate with a dent and a scratch on a robot's table, a ring of eight segments and a dome; the
/// camera is on the flange. 204 x 170 pixels, four views.
inline constexpr const char* kTrialScene = R"(schema = 2
title = "Ring or dome"
[part]
shape = "plate"
length_mm = 48
width_mm = 36
thickness_mm = 5
[material]
type = "conductor"
colour_srgb = [196, 199, 199]
roughness = 0.4
[camera]
width_px = 204
height_px = 170
pixel_um = 41.4
object_pixel_mm = 0.3
working_distance_mm = 180
[sensor]
wavelengths_nm = [630]
blur_px = 0.7
bits = 8
full_well_e = 10000
read_noise_e = 10
[defects.dent]
x_mm = [-10]
y_mm = [5]
height_um = 120
diameter_mm = 3
[defects.scratch]
x_mm = [4]
y_mm = [-7]
height_um = 40
length_mm = 10
width_mm = 1
angle_deg = 50
[lighting.ring]
mount = "camera"
inner_radius_mm = 36
outer_radius_mm = 56
height_mm = 120
segments = 8
radiance = [2.2]
[lighting.dome]
mount = "camera"
position_mm = [0, 0, 160]
radius_mm = 90
opening_mm = 44
radiance = [0.8]
[render.paths]
samples = 16
max_reflections = 1
batches = 2
[calibration.flange_from_camera]
translation_mm = [0, 50, 30]
sigma_mm = [0.04, 0.04, 0.04]
sigma_deg = [0.012, 0.012, 0.012]
[cell.base_from_part]
translation_mm = [280, -120, 20]
sigma_mm = [0.03, 0.03, 0.03]
sigma_deg = [0.02, 0.02, 0.02]
[[viewpoint]]
position_mm = [0, 0, 180]
direction = [0, 0, -1]
up = [0, 1, 0]
[[viewpoint]]
position_mm = [0, -37.424, 176.067]
direction = [0, 0.207912, -0.978148]
up = [0.34202, 0.939693, 0]
[[viewpoint]]
position_mm = [37.333, 12.556, 175.638]
direction = [-0.207405, -0.069756, -0.975765]
up = [-0.258819, 0.965926, 0]
[[viewpoint]]
position_mm = [-37.333, 12.556, 175.638]
direction = [0.207405, -0.069756, -0.975765]
up = [-0.422618, 0.906308, 0]
)";

/// What a study adds to the scene.
inline constexpr const char* kTrialStudy = R"([prototypes.ring]
"lighting.dome.radiance" = [0]
[prototypes.dome]
"lighting.ring.radiance" = [0]
[objective]
maximise = "defects.min_cnr"
)";

/// What reality differs by.
struct TrialTruth {
  std::function<void(SceneSettings&)> change = {};  ///< of the scene
  std::vector<double> part_turn_deg = {0, 0, 0};    ///< of the part on its table, axis times angle
  std::vector<double> part_shift_mm = {0, 0, 0};
  double position_noise_mm = 0.02;
  double rotation_noise_deg = 0.006;
  int seed = 1;
};

/// Writes the run's folder, with the scenes of the designs alone, and the pictures of `designs`.
/// @param study  what is added to the scene
/// @return the folder; run/ and pictures/ are in it
void make_trial(const std::filesystem::path& folder,
                const TrialTruth& truth,
                const std::vector<std::string>& designs = {"ring"},
                std::size_t views = 4,
                const std::string& study = kTrialStudy,
                const std::string& scene = kTrialScene);

/// Validates it. @return the result
nlohmann::ordered_json validate_trial(const std::filesystem::path& folder,
                                      bool is_refitting = false);

/// A study of the dome alone, with this radiance.
std::string dome_study(const std::string& radiance);

/// Two views of that dome validated, whose pictures are `power` times as bright.
nlohmann::ordered_json validated_dome(const std::string& radiance, double power);

/// Whether the result has a cause of that name that is beyond tolerance.
bool has_cause(const nlohmann::ordered_json& result, const std::string& name);

}  // namespace glint
