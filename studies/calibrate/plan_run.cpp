// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/plan_run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/csv.h"
#include "core/error.h"
#include "core/file.h"
#include "core/median.h"
#include "core/units.h"
#include "hardware/calibration/rotation.h"
#include "hardware/poses/camera_file.h"
#include "hardware/upkeep/pose_plan.h"
#include "studies/calibrate/known_calibration.h"
#include "studies/calibrate/settings_from_sets.h"
#include "studies/output/result_folder.h"
#include "studies/output/result_writer.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Eigen::Isometry3d;
using Json = nlohmann::ordered_json;

const std::array<std::string, 4> plan_files = {"poses.csv", "poses.toml", "plan.json", "run.json"};

PlanSettings plan_settings(const std::vector<KeyValue>& sets) {
  for (const KeyValue& set : sets) {
    if (!is_of_table(set, "plan")) {
      throw ConfigError(
          fmt::format("--set: {}: must begin with \"plan.\", like plan.seed=2", set.path));
    }
  }
  return settings_from_sets<PlanSettings>(sets, "plan");
}

/// What is planned for.
struct Rig {
  PinholeIntrinsics camera;
  Board board;
  std::optional<KnownCalibration> known;  ///< with a hand-eye
  double sharp_near_mm = 0.0;             ///< as the camera's [lens] says
  double sharp_far_mm = std::numeric_limits<double>::infinity();

  bool is_lens_told() const { return sharp_near_mm > 0.0 || std::isfinite(sharp_far_mm); }

  const char* pose_name() const { return known ? "base_from_flange" : "board_from_camera"; }

  /// What the plan tells of a view of the board.
  Isometry3d told(const Isometry3d& board_from_camera) const {
    if (!known) {
      return board_from_camera;
    }
    return flange_that_sees(*known->mounting, known->poses, board_from_camera.inverse());
  }
};

bool is_calibration(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) || path.extension() == ".json";
}

Rig rig_of(const PosePlanOptions& options) {
  if (options.camera.empty()) {
    throw ConfigError("--camera: is missing; give a rough camera's file or a calibration's folder");
  }
  Rig rig;
  if (is_calibration(options.camera)) {
    const KnownCalibration known = read_calibration(options.camera);
    rig.camera = known.intrinsics;
    rig.board = known.board;
    rig.known = known.mounting ? std::optional(known) : std::nullopt;
  } else {
    const CameraFile file = read_camera_file(options.camera);
    rig.camera = file.intrinsics;
    rig.sharp_near_mm = file.sharp_near_mm;
    rig.sharp_far_mm = file.sharp_far_mm;
    if (options.board.empty()) {
      throw ConfigError("--board: is missing; give the board's board.toml or board.json");
    }
  }
  if (!options.board.empty()) {
    rig.board = read_board(options.board);
  }
  if (rig.camera.width_px == 0) {
    throw ConfigError(
        fmt::format("{}: does not state the picture's size", options.camera.string()));
  }
  return rig;
}

/// To the depths at which pictures have the board, a tenth more: there it is sharp; and as far as
/// the outline reaches from its middle when it is tilted most. Medians, so that further pictures do
/// not lead further away.
void keep_sharp(PlanRequest& request) {
  constexpr double kMore = 0.1;
  const Eigen::Vector3d diagonal_mm = request.outline_mm.back() - request.outline_mm.front();
  const Eigen::Vector3d middle_mm = request.outline_mm.front() + 0.5 * diagonal_mm;
  std::vector<double> nearest;
  std::vector<double> middles;
  std::vector<double> farthest;
  for (const Isometry3d& board_from_camera : request.taken) {
    const Isometry3d seen = board_from_camera.inverse();
    std::vector<double> depths;
    for (const Eigen::Vector3d& point : request.board_mm) {
      depths.push_back((seen * point).z());
    }
    nearest.push_back(std::ranges::min(depths));
    middles.push_back((seen * middle_mm).z());
    farthest.push_back(std::ranges::max(depths));
  }
  const double tilted_mm = 0.5 * diagonal_mm.norm() * std::sin(request.tilt_max_rad);
  const double middle = median(middles);
  if (request.near_mm == 0.0) {
    request.near_mm = std::min((1.0 - kMore) * median(nearest), middle - tilted_mm);
  }
  if (request.far_mm == 0.0) {
    request.far_mm = std::max((1.0 + kMore) * median(farthest), middle + tilted_mm);
  }
}

/// Adds to what the calibration's pictures tell.
void add_taken(const KnownCalibration& known,
               const PosePlanOptions& options,
               PlanRequest& request) {
  for (const Isometry3d& pose : options.taken) {
    request.taken.push_back(camera_from_board(*known.mounting, known.poses, pose).inverse());
  }
  keep_sharp(request);
  request.is_free = known.is_free;
  request.noise = known.noise;
  request.mounting = *known.mounting;
  request.poses = known.poses;
  request.aim_mm = options.aim_mm;
  request.aim_rad = options.aim_deg * kRadPerDeg;
}

PosePlan planned(const Rig& rig, const PlanSettings& settings, const PosePlanOptions& options) {
  PlanRequest request{.camera = rig.camera,
                      .board_mm = corners_mm(rig.board),
                      .count = options.count,
                      .near_mm = settings.near_mm,
                      .far_mm = settings.far_mm,
                      .sharp_near_mm = rig.sharp_near_mm,
                      .sharp_far_mm = rig.sharp_far_mm,
                      .tilt_min_rad = settings.tilt_min_rad,
                      .tilt_max_rad = settings.tilt_max_rad,
                      .roll_rad = settings.roll_rad,
                      .margin_px = settings.margin_px,
                      .seed = static_cast<std::uint64_t>(settings.seed)};
  // The outer squares, too, are to be seen.
  for (const int col : {-1, rig.board.cols}) {
    for (const int row : {-1, rig.board.rows}) {
      request.outline_mm.push_back(corner_mm(rig.board, col, row));
    }
  }
  if (rig.known && !options.taken.empty()) {
    add_taken(*rig.known, options, request);
  }
  return settings.method == PlanMethod::kInformation ? informative_poses(request)
                                                     : strided_poses(request);
}

Json pose_json(int number, const Isometry3d& pose, double tilt_deg) {
  const Eigen::Vector3d turn = rotation_vector_rad(pose.linear());
  const Eigen::Vector3d& at = pose.translation();
  return {{"name", fmt::format("{:03}", number)},
          {"translation_mm", {at.x(), at.y(), at.z()}},
          {"rotation_vector_rad", {turn.x(), turn.y(), turn.z()}},
          {"tilt_deg", tilt_deg}};
}

Json notes_json(const Rig& rig, const PlanSettings& settings) {
  Json notes = Json::array();
  if (rig.is_lens_told() && (settings.near_mm == 0.0 || settings.far_mm == 0.0)) {
    notes.push_back(fmt::format(
        "[lens] of the camera's file shows all sharp to one pixel from {:.4g} mm to {}: where "
        "plan.near_mm and plan.far_mm do not say, the whole board stays within",
        rig.sharp_near_mm,
        std::isfinite(rig.sharp_far_mm) ? fmt::format("{:.4g} mm", rig.sharp_far_mm)
                                        : std::string("infinity")));
  }
  return notes;
}

Json plan_json(const Rig& rig, const PosePlan& plan, const PlanSettings& settings) {
  Json poses = Json::array();
  for (const Isometry3d& pose : plan.board_from_camera) {
    const double tilt = std::acos(std::min(1.0, std::abs(pose.linear()(2, 2)))) * kDegPerRad;
    poses.push_back(pose_json(static_cast<int>(poses.size()) + 1, rig.told(pose), tilt));
  }
  const LensVector& sigma = plan.lens_sigma;
  return {{"schema", 1},
          {"status", "done"},
          {"pose", rig.pose_name()},
          {"poses", poses},
          {"near_mm", plan.near_mm},
          {"far_mm", plan.far_mm},
          {"notes", notes_json(rig, settings)},
          {"promised",
           {{"focal_px", {sigma[0], sigma[1]}},
            {"center_px", {sigma[2], sigma[3]}},
            {"hand_eye_deg", plan.hand_eye_rad * kDegPerRad},
            {"hand_eye_mm", plan.hand_eye_mm}}}};
}

/// What the hand-eye is known to before the first pose and with each.
void add_foretold(const PosePlan& plan, Json& json) {
  const auto told = [](const HandEyeSigma& sigma) {
    return Json{{"hand_eye_deg", sigma.rad * kDegPerRad}, {"hand_eye_mm", sigma.mm}};
  };
  json["before"] = told(plan.before);
  json["after"] = Json::array();
  std::ranges::transform(plan.after, std::back_inserter(json["after"]), told);
}

/// Numbers of a pose: place in mm, rotation vector in rad.
std::array<double, 6> numbers_of(const Json& pose) {
  std::array<double, 6> numbers = {};
  for (std::size_t i = 0; i < 3; ++i) {
    numbers[i] = pose["translation_mm"][i].get<double>();
    numbers[3 + i] = pose["rotation_vector_rad"][i].get<double>();
  }
  return numbers;
}

std::string poses_csv(const Json& plan) {
  std::string text =
      fmt::format("# {}: mm and rotation vector in rad\n", plan["pose"].get<std::string>());
  text += csv_row_of("name", "x_mm", "y_mm", "z_mm", "rx_rad", "ry_rad", "rz_rad");
  for (const Json& pose : plan["poses"]) {
    const auto n = numbers_of(pose);
    text += csv_row_of(pose["name"].get<std::string>(), n[0], n[1], n[2], n[3], n[4], n[5]);
  }
  return text;
}

/// With the convention that `--poses` then has not to guess.
std::string poses_toml(const Json& plan) {
  std::string text =
      "[convention]\nunit = \"mm\"\nrotation = \"rotation_vector\"\nangle = \"rad\"\n";
  if (plan["pose"] == "base_from_flange") {
    text += "direction = \"base_from_flange\"\n";
  }
  for (const Json& pose : plan["poses"]) {
    const auto n = numbers_of(pose);
    text += fmt::format("\n[[pose]]\nname = \"{}\"\npose = [{}, {}, {}, {}, {}, {}]\n",
                        pose["name"].get<std::string>(),
                        n[0],
                        n[1],
                        n[2],
                        n[3],
                        n[4],
                        n[5]);
  }
  return text;
}

}  // namespace

void visit_keys(KeyVisitor& keys, PlanSettings& settings) {
  constexpr std::array<std::string_view, 2> kMethods = {"information", "strided"};
  keys.choice("method", settings.method, kMethods, "how poses are chosen");
  keys.number("near_mm",
              settings.near_mm,
              Range::at_least(0.0),
              "in focus from here; 0: by the board's size");
  keys.number(
      "far_mm", settings.far_mm, Range::at_least(0.0), "in focus to here; 0: by the board's size");
  keys.number("tilt_min_deg", settings.tilt_min_rad, Range::between(0.0, 60.0), "least tilt");
  keys.number("tilt_max_deg", settings.tilt_max_rad, Range::between(0.0, 60.0), "largest tilt");
  keys.number("roll_deg", settings.roll_rad, Range::between(0.0, 180.0), "roll to both sides");
  keys.number("margin_px", settings.margin_px, Range::at_least(0.0), "from the picture's border");
  keys.integer("seed", settings.seed, Range::at_least(0), "of the random poses");
  keys.require(settings.tilt_min_rad <= settings.tilt_max_rad,
               "tilt_min_deg",
               "must not be above tilt_max_deg");
  keys.require(settings.far_mm == 0.0 || settings.near_mm < settings.far_mm,
               "near_mm",
               "must be below far_mm");
}

Json plan_poses(const PosePlanOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const PlanSettings settings = plan_settings(options.sets);
  const fs::path stem =
      options.camera.has_filename() ? options.camera.stem() : options.camera.parent_path().stem();
  const fs::path out =
      options.out.empty()
          ? default_result_folder(stem.empty() ? "camera" : stem.string(), ResultKind::kPlan)
          : options.out;
  check_result_folder(out, ResultKind::kPlan, plan_files);
  check_inputs_kept(std::array{options.board, options.camera}, out, plan_files);
  if (options.out.empty()) {
    check_source_of_folder(out, {options.camera});
  }
  const Rig rig = rig_of(options);
  const PosePlan poses = planned(rig, settings, options);
  Json plan = plan_json(rig, poses, settings);
  if (!poses.after.empty()) {
    add_foretold(poses, plan);
  }
  ResultWriter writer(out, ResultKind::kPlan);
  write_file(writer.path() / "poses.csv", poses_csv(plan));
  write_file(writer.path() / "poses.toml", poses_toml(plan));
  write_file(writer.path() / "plan.json", plan.dump(2) + "\n");
  writer.finish({{"source", source_seen_from(out, options.camera)}}, start);
  plan["folder"] = out.string();
  return plan;
}

}  // namespace glint
