// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/place_scene_run.h"

#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "studies/calibrate_cell/edge_placement.h"
#include "studies/calibrate_cell/part_views.h"
#include "studies/output/output_folder.h"
#include "studies/output/result_folder.h"

namespace glint {
namespace {

using calibrate_cell_detail::EdgePlacing;
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

const std::array<std::string, 6> kScenePlaceFiles = {
    "placement.toml", "placement.json", "run.json", "edges.csv", "poses.toml", "simulated"};

void check_scene_options(const CalibrateOptions& options) {
  if (options.pictures.empty()) {
    throw ConfigError("PICTURES: there are none, must show the part from several sides");
  }
  if (options.camera.empty()) {
    throw ConfigError("--camera: is missing; give the folder of a calibration");
  }
  if (options.poses.empty()) {
    throw ConfigError(
        "--poses: is missing; the camera is on the flange, so what it sees depends on them");
  }
}

/// @throws ConfigError for a picture that the calibration is not of
void check_picture_sizes(const SceneSettings& scene, const std::vector<fs::path>& pictures) {
  for (const fs::path& picture : pictures) {
    const ImageF image = read_image(picture);
    if (image.width() != scene.camera.width_px || image.height() != scene.camera.height_px) {
      throw ConfigError(fmt::format("{}: has {} x {} pixels, the camera of --camera {} x {}",
                                    picture.string(),
                                    image.width(),
                                    image.height(),
                                    scene.camera.width_px,
                                    scene.camera.height_px));
    }
  }
}

/// The folder of a calibration, of which calibration.json may be named, too.
fs::path calibration_folder_of(const fs::path& camera) {
  return fs::is_directory(camera) ? camera : camera.parent_path();
}

EdgePlacing placing_of(const fs::path& scene, const CalibrateOptions& options) {
  const fs::path calibration = calibration_folder_of(options.camera);
  EdgePlacing placing = {.scene = calibrate_cell_detail::part_scene(scene, calibration),
                         .calibration = calibration,
                         .threads = options.threads};
  check_picture_sizes(placing.scene, options.pictures);
  CalibrateOptions reading = {.pictures = options.pictures, .poses = options.poses};
  const auto is_of_place = [](const KeyValue& set) { return set.path.starts_with("place."); };
  std::ranges::copy_if(options.sets, std::back_inserter(placing.sets), is_of_place);
  std::ranges::remove_copy_if(options.sets, std::back_inserter(reading.sets), is_of_place);
  const std::vector<Eigen::Isometry3d> flanges = poses_of_pictures(reading);
  for (std::size_t i = 0; i < flanges.size(); ++i) {
    placing.photos.push_back({.name = options.pictures[i].string(),
                              .file = options.pictures[i],
                              .base_from_flange = flanges[i]});
  }
  return placing;
}

}  // namespace

bool is_part_scene(const fs::path& file) {
  return file.extension() == ".toml" && load_toml(file).find("part") != nullptr;
}

Json place_scene_part(const fs::path& scene, const CalibrateOptions& options) {
  check_scene_options(options);
  const EdgePlacing placing = placing_of(scene, options);
  const fs::path out = options.out.empty()
                           ? default_result_folder(scene.stem().string(), ResultKind::kPlace)
                           : options.out;
  check_result_folder(out, ResultKind::kPlace, kScenePlaceFiles);
  std::vector<fs::path> inputs = options.pictures;
  inputs.insert(inputs.end(), options.poses.begin(), options.poses.end());
  inputs.push_back(scene);
  check_inputs_kept(inputs, out, kScenePlaceFiles);
  OutputFolder folder(out);
  mark_result_folder(out, ResultKind::kPlace);
  const auto found = place_by_edges(placing,
                                    {.edges = out / "edges.csv",
                                     .poses = out / "poses.toml",
                                     .simulated = out / "simulated",
                                     .place = out});
  if (!found.is_found) {
    throw ConfigError(
        fmt::format("{}: its edges are found in {} of {} pictures, must be in two or more: are "
                    "lights, poses and [cell.base_from_part] those of the pictures?",
                    scene.string(),
                    found.pictures,
                    options.pictures.size()));
  }
  Json json = found.place;
  json["placements"][0]["by"] = "edges";
  json["passes"] = found.passes;
  Json kept = json;
  kept.erase("folder");
  write_file(out / "placement.json", kept.dump(2) + "\n");
  folder.keep();
  return json;
}

}  // namespace glint
