// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/calibrate_input.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/file.h"
#include "core/image/image_io.h"
#include "hardware/board/board_files.h"
#include "hardware/poses/pose_pairing.h"
#include "hardware/poses/pose_reading.h"
#include "studies/calibrate/corner_file.h"
#include "studies/calibrate/settings_from_sets.h"
#include "studies/report/report.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kFewPictures = 16;  ///< that many are shown larger on the report's page
constexpr const char* kTable = "convention";
constexpr const char* kPriorTable = "prior";
constexpr const char* kPairBy = "poses.pair_by";
constexpr const char* kPredictionTable = "prediction";
constexpr int kMaxSplits = 100;

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

/// Where nothing is calibrated: of the poses alone.
void check_pose_sets(const CalibrateOptions& options) {
  check_sets_are_of_poses(options.sets);
  for (const KeyValue& set : options.sets) {
    if (options.poses.empty()) {
      throw ConfigError(fmt::format("--set: {}: needs --poses", set.path));
    }
  }
}

/// Each --set with what it needs.
void check_sets(const CalibrateOptions& options) {
  for (const KeyValue& set : options.sets) {
    const bool is_prior = is_of_table(set, kPriorTable);
    if (!is_prior && set.path != kPairBy && !is_of_table(set, kTable) &&
        !is_of_table(set, kPredictionTable)) {
      throw ConfigError(fmt::format(
          "--set: {}: must begin with \"convention.\", like convention.unit=m, or with \"prior.\", "
          "like prior.focal_px=5, or be {} or prediction.splits",
          set.path,
          kPairBy));
    }
    if (is_prior ? options.camera.empty() : options.poses.empty()) {
      throw ConfigError(
          fmt::format("--set: {}: needs {}", set.path, is_prior ? "--camera" : "--poses"));
    }
  }
}

/// How well pictures are predicted that were left out.
struct PredictionSettings {
  int splits = 0;  ///< 0: not said
};

void visit_keys(KeyVisitor& keys, PredictionSettings& settings) {
  keys.integer(
      "splits", settings.splits, Range::between(1, kMaxSplits), "random splits in five parts");
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
  const auto prior = settings_from_sets<CameraPrior>(options.sets, kPriorTable);
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
  if (options.pictures.empty() && options.from.empty()) {
    throw ConfigError("PICTURES: there are none; give the pictures of the board");
  }
  if (!options.pictures.empty() && !options.from.empty()) {
    throw ConfigError("--from: takes the corners of a file; give no PICTURES beside it");
  }
  if (options.board.empty() && !options.known_board) {
    throw ConfigError("--board: is missing; give the board's board.toml or board.json");
  }
  const std::pair<const char*, bool> of_poses[] = {{"--method", !options.method.empty()},
                                                   {"--setup", !options.setup.empty()}};
  for (const auto& [option, is_given] : of_poses) {
    if (is_given && options.poses.empty()) {
      throw ConfigError(fmt::format("{}: needs --poses", option));
    }
  }
  if (options.known_board) {
    check_pose_sets(options);
  } else {
    check_sets(options);
  }
}

void read_robot(const CalibrateOptions& options, CalibrateInput& input) {
  input.setup = options.setup.empty() ? input.board.setup : setup_of(options.setup);
  if (!options.method.empty()) {
    input.method = method_of(options.method);
  }
  input.poses = read_poses(options.poses, settings_from_sets<PoseConvention>(options.sets, kTable));
  input.convention =
      options.are_known_poses ? options.first_convention : std::optional(input.poses->convention);
  input.notes = input.poses->told;
  std::vector<std::string> pose_names;
  for (const RobotPose& pose : input.poses->poses) {
    pose_names.push_back(pose.name);
  }
  Pairing pairing = pair_poses(input.names, pose_names, said_pairing(options.sets));
  input.pose_of = std::move(pairing.pose_of);
  input.notes.push_back(std::move(pairing.told));
}

/// Small and as bright as it can be: the report's contact sheet.
std::string small_picture(const Pixels& pixels, int width_px) {
  const ImageF values = linear_values(pixels);
  const float brightest = std::ranges::max(values.values());
  return report_png(stretched(values, 0.0F, brightest), width_px);
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

void look_for_boards(const CalibrateOptions& options, CalibrateInput& input, ThreadPool& pool) {
  const int shown_width_px = std::ssize(options.pictures) <= kFewPictures ? 640 : 420;
  input.shown.resize(options.pictures.size());
  BoardsInFiles found =
      find_boards(options.pictures, input.board, pool, [&](std::size_t i, const Picture& picture) {
        input.shown[i] = small_picture(picture.pixels, shown_width_px);
      });
  input.width_px = found.width_px;
  input.height_px = found.height_px;
  input.views = std::move(found.views);
  if (found.code_bits != 0) {
    input.notes.push_back(
        fmt::format("the pictures have codes of {} bits in files of 16: guessed, the largest is {}",
                    found.code_bits,
                    found.largest_code));
  }
}

/// A mark that hardly any picture shows is as none: a glare spot may look like one. With poses a
/// picture whose mark alone is not found is of no use, as its first corner is not known.
void judge_marks(CalibrateInput& input) {
  constexpr double kFewMarks = 0.2;
  const auto is_unknown = [](const BoardView& view) {
    return view.is_accepted() && !view.is_orientation_known;
  };
  const auto seen = std::ranges::count_if(input.views, &BoardView::is_accepted);
  const auto known = seen - std::ranges::count_if(input.views, is_unknown);
  if (!input.board.mark || known == seen) {
    return;
  }
  Board plain = input.board;
  plain.mark = false;
  if (static_cast<double>(known) <= kFewMarks * static_cast<double>(seen)) {
    input.board = plain;
    input.notes.push_back(fmt::format(
        "mark = true: {} of {} pictures show the mark in the board's first square, so the board is "
        "taken as one without a mark",
        known,
        seen));
    return;
  }
  // Sides of an odd sum settle the first corner by their colours.
  const bool needs_mark = input.poses && num_symmetries(plain) > 1;
  for (BoardView& view : input.views) {
    if (needs_mark && is_unknown(view)) {
      view.outcome = BoardOutcome::kNoBoard;
      view.why = "the mark in the board's first square was not found";
    }
  }
}

/// A larger board in more pictures than the one given is the board; in a few it is something else
/// in view.
void check_size_of_board(const CalibrateOptions& options, const CalibrateInput& input) {
  const auto is_larger = [](const BoardView& view) { return !view.larger_grid.isZero(); };
  const auto larger = std::ranges::count_if(input.views, is_larger);
  if (larger <= std::ranges::count_if(input.views, &BoardView::is_accepted)) {
    return;
  }
  Eigen::Vector2i least = Eigen::Vector2i::Zero();
  for (const BoardView& view : input.views) {
    least = least.cwiseMax(view.larger_grid);
  }
  throw ConfigError(fmt::format(
      "the board in the pictures is larger than {} says: it has at least {} x {} inner corners, "
      "not {} x {}",
      options.board.empty() ? "the board given" : options.board.string(),
      least.x(),
      least.y(),
      input.board.cols,
      input.board.rows));
}

void take_corners(CalibrateInput& input, FoundCorners found) {
  input.width_px = found.width_px;
  input.height_px = found.height_px;
  input.views = std::move(found.views);
  input.shown.resize(input.views.size());
}

/// What was found in the pictures is judged, and becomes the corners of the calibration.
void judge_boards(const CalibrateOptions& options, CalibrateInput& input) {
  check_camera_size(options, input);
  check_any_board(input);
  reject_doubled(input.views, input.names);
  for (const BoardView& view : input.views) {
    input.corners.push_back(
        view.is_accepted() ? BoardCorners{.board_mm = view.board_mm, .picture_px = view.picture_px}
                           : BoardCorners{});
  }
}

/// The board that a calibration knows, as its file describes it.
bool is_known_board(const CalibrateOptions& options, const Board& board) {
  if (!options.known_board) {
    return false;
  }
  const Board& given = options.known_given;
  return board.kind == given.kind && board.cols == given.cols && board.rows == given.rows &&
         board.mark == given.mark && board.dictionary == given.dictionary &&
         board.square_mm == given.square_mm;
}

/// Of a board that a calibration found to have squares of another size than its file says, or not
/// to have its mark, what it found.
Board board_of(const CalibrateOptions& options) {
  if (options.board.empty()) {
    return *options.known_board;
  }
  Board board = read_board(options.board);
  if (is_known_board(options, board)) {
    board.mark = options.known_board->mark;
    board.square_mm = options.known_board->square_mm;
    board.marker_mm = options.known_board->marker_mm;
  }
  return board;
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

void check_sets_are_of_poses(const std::vector<KeyValue>& sets) {
  for (const KeyValue& set : sets) {
    if (set.path != kPairBy && !is_of_table(set, kTable)) {
      throw ConfigError(fmt::format(
          "--set: {}: must begin with \"convention.\", like convention.unit=m, or be {}",
          set.path,
          kPairBy));
    }
  }
}

std::vector<Eigen::Isometry3d> poses_of_pictures(const CalibrateOptions& options) {
  check_pose_sets(options);
  CalibrateInput input;
  for (const fs::path& picture : options.pictures) {
    input.names.push_back(picture.string());
  }
  read_robot(options, input);
  return picture_poses(input, input.poses->convention);
}

CalibrateInput read_calibrate_input(const CalibrateOptions& options, ThreadPool& pool) {
  check_given(options);
  CalibrateInput input;
  FoundCorners found;
  if (!options.from.empty()) {
    found = parse_corners(read_file(options.from), options.from.string());
    input.names = found.names;
  }
  for (const fs::path& picture : options.pictures) {
    input.names.push_back(picture.string());
  }
  input.board = board_of(options);
  input.given_board = input.board;
  input.five_fold_splits =
      settings_from_sets<PredictionSettings>(options.sets, kPredictionTable).splits;
  if (!options.camera.empty()) {
    read_known_camera(options, input);
  }
  if (!options.poses.empty()) {
    read_robot(options, input);
  }
  if (options.from.empty()) {
    look_for_boards(options, input, pool);
    check_size_of_board(options, input);
  } else {
    check_corners(found, input.board, options.from.string());
    take_corners(input, std::move(found));
  }
  judge_marks(input);
  judge_boards(options, input);
  return input;
}

}  // namespace glint
