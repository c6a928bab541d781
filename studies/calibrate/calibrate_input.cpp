// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/calibrate_input.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/config/keys.h"
#include "core/config/toml.h"
#include "core/image/image_io.h"
#include "hardware/poses/pose_pairing.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr const char* kTable = "convention";
constexpr const char* kPriorTable = "prior";
constexpr const char* kPairBy = "poses.pair_by";

/// What the command line says of which pose belongs to which picture.
PairBy said_pairing(const std::vector<KeyValue>& sets) {
  PairBy by = PairBy::kAuto;
  for (const KeyValue& set : sets) {
    if (set.path == kPairBy) {
      const std::array<const char*, 4> names = {"auto", "name", "last_number", "order"};
      const auto found = std::ranges::find(names, set.value);
      if (found == names.end()) {
        throw ConfigError(fmt::format(
            "--set: {}: is {}, must be auto, name, last_number or order", kPairBy, set.value));
      }
      by = static_cast<PairBy>(found - names.begin());
    }
  }
  return by;
}

/// The settings that the command line gives a table.
template <class Settings>
Settings said_settings(const std::vector<KeyValue>& sets, const std::string& name) {
  ConfigNode root = ConfigNode::table();
  for (const KeyValue& set : sets) {
    if (set.path.starts_with(name + ".")) {
      ConfigNode value = parse_override(set.value);
      value.place = {.file = "--set"};
      set_path(root, set.path, std::move(value));
    }
  }
  Settings settings;
  std::vector<Problem> errors;
  KeyReader reader(root.find(name), name, errors);
  visit_keys(reader, settings);
  reader.report_unknown();
  throw_if_any(errors);
  return settings;
}

/// Each --set with what it needs.
void check_sets(const CalibrateOptions& options) {
  for (const KeyValue& set : options.sets) {
    const bool is_prior = set.path.starts_with(std::string(kPriorTable) + ".");
    if (!is_prior && set.path != kPairBy && !set.path.starts_with(std::string(kTable) + ".")) {
      throw ConfigError(fmt::format(
          "--set: {}: must begin with \"convention.\", like convention.unit=m, or with \"prior.\", "
          "like prior.focal_px=5, or be {}",
          set.path,
          kPairBy));
    }
    if (is_prior ? options.camera.empty() : options.poses.empty()) {
      throw ConfigError(
          fmt::format("--set: {}: needs {}", set.path, is_prior ? "--camera" : "--poses"));
    }
  }
}

/// Standard deviations of a known camera's numbers; 0: exact.
struct CameraPrior {
  double focal_px = 0.0;
  double center_px = 0.0;
  double radial = 0.0;
  double tangential = 0.0;
};

void visit_keys(KeyVisitor& keys, CameraPrior& prior) {
  const Range sigma = Range::at_least(0.0);
  keys.number("focal_px", prior.focal_px, sigma, "of each focal length; 0: exact");
  keys.number("center_px", prior.center_px, sigma, "of each coordinate of the principal point");
  keys.number("radial", prior.radial, sigma, "of k1, k2 and k3");
  keys.number("tangential", prior.tangential, sigma, "of p1 and p2");
}

void read_known_camera(const CalibrateOptions& options, CalibrateInput& input) {
  input.camera = read_camera_file(options.camera);
  const auto prior = said_settings<CameraPrior>(options.sets, kPriorTable);
  LensVector sigma;
  sigma << prior.focal_px, prior.focal_px, prior.center_px, prior.center_px,
      Eigen::Vector3d::Constant(prior.radial), Eigen::Vector2d::Constant(prior.tangential);
  if (sigma.maxCoeff() > 0.0) {
    input.camera_sigma = sigma;
  }
}

BoardSetup setup_of(const std::string& name) {
  if (name == "eye_in_hand") {
    return BoardSetup::kEyeInHand;
  }
  if (name == "eye_to_hand") {
    return BoardSetup::kEyeToHand;
  }
  throw ConfigError(fmt::format("--setup {}: must be eye_in_hand or eye_to_hand", name));
}

HandEyeMethod method_of(const std::string& name) {
  if (const auto method = hand_eye_method(name)) {
    return *method;
  }
  std::string names;
  for (const HandEyeMethod method : kHandEyeMethods) {
    names += fmt::format("{}{}", names.empty() ? "" : ", ", name_of(method));
  }
  throw ConfigError(fmt::format("--method {}: must be one of {}", name, names));
}

void check_given(const CalibrateOptions& options) {
  if (options.pictures.empty()) {
    throw ConfigError("PICTURES: there are none; give the pictures of the board");
  }
  if (options.board.empty()) {
    throw ConfigError("--board: is missing; give the board's board.toml or board.json");
  }
  const std::pair<const char*, bool> of_poses[] = {{"--method", !options.method.empty()},
                                                   {"--setup", !options.setup.empty()}};
  for (const auto& [option, is_given] : of_poses) {
    if (is_given && options.poses.empty()) {
      throw ConfigError(fmt::format("{}: needs --poses", option));
    }
  }
  check_sets(options);
}

void read_robot(const CalibrateOptions& options, CalibrateInput& input) {
  input.setup = options.setup.empty() ? input.board.setup : setup_of(options.setup);
  if (!options.method.empty()) {
    input.method = method_of(options.method);
  }
  input.poses = read_poses(options.poses, said_settings<PoseConvention>(options.sets, kTable));
  input.notes = input.poses->told;
  std::vector<std::string> pose_names;
  for (const RobotPose& pose : input.poses->poses) {
    pose_names.push_back(pose.name);
  }
  Pairing pairing = pair_poses(input.names, pose_names, said_pairing(options.sets));
  input.pose_of = std::move(pairing.pose_of);
  input.notes.push_back(std::move(pairing.told));
}

/// One picture's size and board.
struct SeenPicture {
  int width_px = 0;
  int height_px = 0;
  BoardView view;
};

SeenPicture seen_picture(const fs::path& file, const Board& board) {
  const Picture picture = read_picture(file);
  return {.width_px = picture.width(),
          .height_px = picture.height(),
          .view = find_board(picture.pixels, board)};
}

void take_size(CalibrateInput& input, const std::vector<SeenPicture>& seen) {
  input.width_px = seen.front().width_px;
  input.height_px = seen.front().height_px;
  for (std::size_t i = 1; i < seen.size(); ++i) {
    if (seen[i].width_px != input.width_px || seen[i].height_px != input.height_px) {
      throw ConfigError(
          fmt::format("{}: has {} x {} pixels, {} has {} x {}; pictures of one camera "
                      "have one size",
                      input.names[i],
                      seen[i].width_px,
                      seen[i].height_px,
                      input.names.front(),
                      input.width_px,
                      input.height_px));
    }
  }
}

void check_camera_size(const CalibrateOptions& options, const CalibrateInput& input) {
  if (!input.camera) {
    return;
  }
  const PinholeIntrinsics& known = input.camera->intrinsics;
  if (known.width_px > 0 &&
      (known.width_px != input.width_px || known.height_px != input.height_px)) {
    throw ConfigError(fmt::format("{}: is a camera of {} x {} pixels, the pictures have {} x {}",
                                  options.camera.string(),
                                  known.width_px,
                                  known.height_px,
                                  input.width_px,
                                  input.height_px));
  }
}

void check_any_board(const CalibrateInput& input) {
  if (std::ranges::any_of(input.views, &BoardView::is_accepted)) {
    return;
  }
  throw ConfigError(fmt::format("no picture shows the whole board of {} x {} corners; {}: {}: {}",
                                input.board.cols,
                                input.board.rows,
                                input.names.front(),
                                outcome_name(input.views.front().outcome),
                                input.views.front().why));
}

void find_boards(const CalibrateOptions& options, CalibrateInput& input, ThreadPool& pool) {
  const auto count = static_cast<std::int64_t>(options.pictures.size());
  std::vector<SeenPicture> seen = pool.map<SeenPicture>(count, [&](std::int64_t i) {
    return seen_picture(options.pictures[static_cast<std::size_t>(i)], input.board);
  });
  take_size(input, seen);
  check_camera_size(options, input);
  for (SeenPicture& picture : seen) {
    input.views.push_back(std::move(picture.view));
  }
  check_any_board(input);
  reject_doubled(input.views, input.names);
  for (const BoardView& view : input.views) {
    input.corners.push_back(
        view.is_accepted() ? BoardCorners{.board_mm = view.board_mm, .picture_px = view.picture_px}
                           : BoardCorners{});
  }
}

}  // namespace

std::vector<Eigen::Isometry3d> picture_poses(const CalibrateInput& input,
                                             const PoseConvention& convention) {
  std::vector<Eigen::Isometry3d> poses;
  for (const std::size_t pose : input.pose_of) {
    poses.push_back(base_from_flange(input.poses->written[pose], convention));
  }
  return poses;
}

CalibrateInput read_calibrate_input(const CalibrateOptions& options, ThreadPool& pool) {
  check_given(options);
  CalibrateInput input;
  for (const fs::path& picture : options.pictures) {
    input.names.push_back(picture.string());
  }
  input.board = read_board(options.board);
  if (!options.camera.empty()) {
    read_known_camera(options, input);
  }
  if (!options.poses.empty()) {
    read_robot(options, input);
  }
  find_boards(options, input, pool);
  return input;
}

}  // namespace glint
