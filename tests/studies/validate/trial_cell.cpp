// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/studies/validate/trial_cell.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/thread_pool.h"
#include "core/units.h"
#include "studies/acquire/acquired.h"
#include "studies/definition/study.h"
#include "studies/imaging/path_lights.h"
#include "studies/twin_cell/cell_renderer.h"
#include "studies/validate/light_changes.h"
#include "studies/validate/validate_run.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

std::vector<double> radians(const std::vector<double>& degrees) {
  std::vector<double> values;
  for (const double value : degrees) {
    values.push_back(value * kRadPerDeg);
  }
  return values;
}

std::vector<std::string> lights_of(const SceneSettings& scene) {
  std::vector<std::string> names;
  for (const LitLight& light : lights_with_bodies(scene)) {
    names.push_back(light.name);
  }
  if (scene.has_tunnel && std::ranges::find(names, scene.tunnel_name) == names.end()) {
    names.push_back(scene.tunnel_name);
  }
  return names;
}

Truth truth_of(const SceneSettings& scene, const TrialTruth& trial) {
  Truth truth = {.scene = scene};
  truth.scene.paths.samples = 64;  // a camera has no noise of rendering
  if (trial.change) {
    trial.change(truth.scene);
  }
  const auto& camera = scene.calibration->flange_from_camera->pose;
  const auto& part = scene.cell->base_from_part->pose;
  const RigidTransform base_from_scene =
      transform_of(part) * pose_of(trial.part_shift_mm, radians(trial.part_turn_deg));
  const PoseSettings placed = pose_settings(base_from_scene);
  truth.settings = {.camera_position_mm = camera.translation_mm,
                    .camera_rotation_rad = camera.rotation_vector_rad,
                    .scene_position_mm = placed.translation_mm,
                    .scene_rotation_rad = placed.rotation_vector_rad,
                    .exposure_s = 0.005,
                    .position_noise_mm = trial.position_noise_mm,
                    .rotation_noise_rad = trial.rotation_noise_deg * kRadPerDeg,
                    .seed = trial.seed};
  return truth;
}

/// Of all trials: designs and powers of lights differ, the paths that light takes do not.
SceneStore& store_of_pictures() {
  static ThreadPool pool(2);
  static SceneStore store(pool, std::size_t{512} << 20U);
  return store;
}

void take_pictures(const SceneSettings& scene,
                   const TrialTruth& trial,
                   std::size_t views,
                   const fs::path& folder) {
  CellRenderer renderer(truth_of(scene, trial), store_of_pictures());
  Json pictures = Json::array();
  const RigidTransform camera_from_flange =
      inverse(transform_of(scene.calibration->flange_from_camera->pose));
  const RigidTransform base_from_part = transform_of(scene.cell->base_from_part->pose);
  for (std::size_t i = 0; i < std::min(views, scene.viewpoints.size()); ++i) {
    const RigidTransform base_from_flange =
        base_from_part * inverse(camera_from_world(scene.viewpoints[i])) * camera_from_flange;
    const Image<std::uint16_t> codes =
        renderer.render({.base_from_flange = base_from_flange, .lights = lights_of(scene)},
                        {.exposure_us = 5000, .gain_db = 0, .black_level = 0, .bits = 8});
    ImageF grey(codes.width(), codes.height());
    std::ranges::transform(codes.values(), grey.values().begin(), [](std::uint16_t code) {
      return static_cast<float>(code) / 255.0F;
    });
    const std::string name = fmt::format("view_{:02}", i + 1);
    const std::string file = "views/" + name + "/sequence/frame_000.png";
    make_folder((folder / file).parent_path());
    write_png(folder / file, grey, PixelDepth::k8Bit);
    AcquiredPicture picture = {.view = name,
                               .file = file,
                               .position_sigma_mm = trial.position_noise_mm,
                               .rotation_sigma_rad = trial.rotation_noise_deg * kRadPerDeg};
    picture.base_from_flange.linear() = base_from_flange.rotation;
    picture.base_from_flange.translation() = base_from_flange.translation_mm;
    pictures.push_back(picture_json(picture));
  }
  write_file(folder / "acquired.json",
             Json{{"schema", 1},
                  {"kind", "acquired"},
                  {"status", "complete"},
                  {"calibration", nullptr},
                  {"twin", true},
                  {"pictures", pictures}}
                 .dump(2));
}

}  // namespace

void make_trial(const fs::path& folder,
                const TrialTruth& truth,
                const std::vector<std::string>& designs,
                std::size_t views,
                const std::string& study_tables,
                const std::string& scene_tables) {
  make_folder(folder / "run");
  write_file(folder / "run" / "study.resolved.toml", scene_tables + study_tables);
  const Study study = load_study(folder / "run" / "study.resolved.toml", {});
  for (const Prototype& prototype : study.prototypes) {
    const SceneSettings scene = scene_with(study, prototype.overrides);
    make_folder(folder / "run" / prototype.name);
    write_file(folder / "run" / prototype.name / "scene.toml",
               "schema = 2\n" + to_toml(write_scene(scene)));
    if (std::ranges::find(designs, prototype.name) != designs.end()) {
      take_pictures(scene, truth, views, folder / "pictures" / prototype.name);
    }
  }
}

Json validate_trial(const fs::path& folder, bool is_refitting) {
  return validate_run({.run = folder / "run",
                       .pictures = folder / "pictures",
                       .out = folder / "out",
                       .is_refitting = is_refitting,
                       .threads = 2,
                       .progress = Progress::Style::kNone});
}

std::string dome_study(const std::string& radiance) {
  return "[prototypes.dome]\n\"lighting.ring.radiance\" = [0]\n\"lighting.dome.radiance\" = [" +
         radiance + "]\n";
}

Json validated_dome(const std::string& radiance, double power) {
  const TemporaryFolder folder;
  const auto change = [power](SceneSettings& scene) { scene.sensor.exposure *= power; };
  make_trial(folder.path(), {.change = change, .seed = 5}, {"dome"}, 2, dome_study(radiance));
  return validate_trial(folder.path());
}

bool has_cause(const Json& result, const std::string& name) {
  const Json& causes = result["causes"];
  return std::ranges::any_of(causes, [&](const Json& cause) {
    return cause["name"] == name && !cause["within_tolerance"].get<bool>();
  });
}

}  // namespace glint
