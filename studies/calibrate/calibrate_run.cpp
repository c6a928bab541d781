// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/calibrate_run.h"

#include <array>
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "core/wall_clock.h"
#include "hardware/calibration/rotation.h"
#include "studies/calibrate/calibrate_files.h"
#include "studies/calibrate/calibrate_page.h"
#include "studies/calibrate/corner_file.h"
#include "studies/calibrate/corner_residuals.h"
#include "studies/calibrate/known_calibration.h"
#include "studies/calibrate/settings_from_sets.h"
#include "studies/calibrate/solved_calibration.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/result_writer.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

// --- What a calibration can be computed from again -----------------------------------------------

/// Of the flange, in the pictures' order. What was guessed or removed is told above them.
std::string poses_toml(const CalibrateInput& input) {
  std::string text = "# Poses of the robot's flange, one for each picture of corners.csv\n";
  for (const std::string& told : input.poses->told) {
    text += fmt::format("# as they were given: {}\n", told);
  }
  text +=
      "[convention]\nunit = \"mm\"\ndirection = \"base_from_flange\"\n"
      "rotation = \"rotation_vector\"\nangle = \"rad\"\n";
  const std::vector<Eigen::Isometry3d> poses = picture_poses(input, input.poses->convention);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::string& name = input.poses->poses[input.pose_of[i]].name;
    const Eigen::Vector3d turn = rotation_vector_rad(poses[i].linear());
    const Eigen::Vector3d& at = poses[i].translation();
    text += "\n[[pose]]\n";
    if (!name.empty()) {
      text += fmt::format("name = {}\n", value_to_toml(ConfigNode::from_text(name)));
    }
    text += fmt::format("pose = [{}, {}, {}, {}, {}, {}]\n",
                        shortest(at.x()),
                        shortest(at.y()),
                        shortest(at.z()),
                        shortest(turn.x()),
                        shortest(turn.y()),
                        shortest(turn.z()));
  }
  return text;
}

/// With the setup that was told, not with one that was guessed.
std::string own_board_toml(const CalibrateInput& input) {
  Board board = input.given_board;
  if (input.poses) {
    board.setup = input.setup;
  }
  return board_toml(board);
}

void write_sources(const CalibrateInput& input, const fs::path& folder) {
  write_file(folder / "board.toml", own_board_toml(input));
  if (input.poses) {
    write_file(folder / "poses.toml", poses_toml(input));
  }
  if (input.camera) {
    write_file(folder / "known_camera.toml", known_camera_toml(input));
  }
}

fs::path source_of(const fs::path& folder, const char* name, const char* option) {
  std::error_code ignored;
  if (!fs::exists(folder / name, ignored)) {
    throw ConfigError(fmt::format(
        "--from {}: has no {}, as of an earlier version; give {}", folder.string(), name, option));
  }
  return folder / name;
}

/// --set prior. of the calibration, before what the user says.
void take_prior(const Json& prior, CalibrateOptions& options) {
  std::vector<KeyValue> sets;
  for (const char* key : {"focal_px", "center_px", "radial", "tangential"}) {
    const double sigma = prior.at(key).at(0).get<double>();
    if (sigma > 0.0) {
      sets.push_back({.path = fmt::format("prior.{}", key), .value = shortest(sigma)});
    }
  }
  options.sets.insert(options.sets.begin(), sets.begin(), sets.end());
}

/// The poses of a folder for --from are of the flange and say so: read otherwise they would be
/// inverted, or a tool taken off them, a second time.
void take_poses(const fs::path& folder, const Json& known, CalibrateOptions& options) {
  for (const KeyValue& set : options.sets) {
    if (is_of_table(set, "convention")) {
      throw ConfigError(fmt::format(
          "--set: {}: --from {} has poses of the flange already, read when it was calibrated; give "
          "the robot's poses with --poses to read them otherwise",
          set.path,
          folder.string()));
    }
  }
  options.poses = {source_of(folder, "poses.toml", "--poses")};
  options.sets.insert(options.sets.begin(), {.path = "poses.pair_by", .value = "order"});
  options.are_known_poses = true;
  options.first_convention = convention_in(known);
}

/// Of a folder for --from: its corners, and what of board, poses and camera is not given. Files of
/// an earlier calibration that lie there, too, are not its own.
void take_sources(CalibrateOptions& options) {
  const fs::path folder = options.from;
  const Json known = Json::parse(read_file(folder / "calibration.json"), nullptr, false);
  options.from = folder / "corners.csv";
  if (options.board.empty()) {
    options.board = source_of(folder, "board.toml", "--board");
  }
  try {
    if (options.poses.empty() && known.at("hand_eye").is_object()) {
      take_poses(folder, known, options);
    }
    const Json& prior = known.at("intrinsics").at("prior");
    if (options.camera.empty() && prior.is_object()) {
      options.camera = source_of(folder, "known_camera.toml", "--camera");
      take_prior(prior, options);
    }
  } catch (const Json::exception&) {
    throw ConfigError(
        fmt::format("--from {}: its calibration.json is none of glint calibrate", folder.string()));
  }
}

/// That of the first picture, or of --from.
fs::path folder_read(const CalibrateOptions& options) {
  std::error_code ignored;
  const fs::path first = options.pictures.empty() ? fs::path() : options.pictures.front();
  return fs::absolute(options.from.empty() ? first : options.from, ignored).parent_path();
}

void check_folder(const CalibrateOptions& options, const fs::path& out) {
  const std::array<std::string, 8> names = {"calibration.toml",
                                            "calibration.json",
                                            "corners.csv",
                                            "board.toml",
                                            "poses.toml",
                                            "known_camera.toml",
                                            "report.html",
                                            "run.json"};
  check_result_folder(out, ResultKind::kCalibrate, names);
  std::vector<fs::path> inputs = options.pictures;
  inputs.insert(inputs.end(), options.poses.begin(), options.poses.end());
  inputs.insert(inputs.end(), {options.from, options.board, options.camera});
  check_inputs_kept(inputs, out, names);
  if (options.out.empty()) {
    check_source_of_folder(out, {folder_read(options)});
  }
}

}  // namespace

Json calibrate_pictures(const CalibrateOptions& given) {
  const auto start = std::chrono::steady_clock::now();
  CalibrateOptions options = given;
  std::error_code ignored;
  if (!options.from.empty() && fs::is_directory(options.from, ignored)) {
    take_sources(options);
  }
  const std::string started = utc_text(std::chrono::system_clock::now());
  const std::vector<fs::path> from = {options.from};
  const fs::path out = options.out.empty()
                           ? folder_of_pictures(options.from.empty() ? options.pictures : from,
                                                ResultKind::kCalibrate)
                           : options.out;
  check_folder(options, out);
  ThreadPool pool(options.threads);
  const CalibrateInput input = read_calibrate_input(options, pool);
  const SolvedCalibration solved = solve_calibration(input, pool);
  const auto residuals_px = corner_residuals_px(input, solved);
  Json result = calibration_json(input, solved, residuals_px);
  ResultWriter writer(out, ResultKind::kCalibrate);
  write_file(writer.path() / "calibration.toml", calibration_toml(input, solved));
  write_file(writer.path() / "calibration.json", result.dump(2) + "\n");
  write_file(writer.path() / "corners.csv", corners_csv(input, solved, residuals_px));
  write_sources(input, writer.path());
  const std::string when = moment_text(started, seconds_since(start));
  write_file(writer.path() / "report.html",
             calibrate_page(result, input, solved, residuals_px, when));
  writer.finish({{"pictures", input.names.size()},
                 {"source", source_seen_from(out, folder_read(options))},
                 {"threads", options.threads}},
                start);
  result["report"] = (out / "report.html").string();
  result["folder"] = out.string();
  return result;
}

}  // namespace glint
