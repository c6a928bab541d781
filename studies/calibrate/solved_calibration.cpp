// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/solved_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>

#include <fmt/format.h>

#include "hardware/calibration/camera_bundle.h"
#include "hardware/calibration/lens_choice.h"
#include "hardware/calibration_review/second_camera.h"
#include "studies/calibrate/known_calibration.h"

namespace glint {
namespace {

using Eigen::Isometry3d;

constexpr int kMaxFolds = 20;

CameraOptions camera_options(const CalibrateInput& input) {
  const auto seen = std::ranges::count_if(input.views, &BoardView::is_accepted);
  CameraOptions options = {
      .width_px = input.width_px,
      .height_px = input.height_px,
      .folds = input.poses ? 5 : std::clamp(static_cast<int>(seen), 2, kMaxFolds)};
  if (input.camera) {
    options.known =
        KnownLens{.lens = lens_vector(input.camera->intrinsics), .sigma = input.camera_sigma};
  }
  return options;
}

/// Without their folders.
std::vector<std::string> file_names(const CalibrateInput& input) {
  std::vector<std::string> names;
  for (const std::string& name : input.names) {
    names.push_back(std::filesystem::path(name).filename().string());
  }
  return names;
}

HandEyeOptions hand_eye_options(const CalibrateInput& input, Mounting mounting) {
  return {.mounting = mounting,
          .camera = camera_options(input),
          .board_turns = num_symmetries(input.board),
          .has_mark = input.board.mark,
          .square_mm = input.board.square_mm,
          .board_center_mm = Eigen::Vector2d(0.5 * (input.board.cols - 1) * input.board.square_mm,
                                             0.5 * (input.board.rows - 1) * input.board.square_mm),
          .names = file_names(input)};
}

const char* setup_name(Mounting mounting) {
  return mounting == Mounting::kEyeInHand ? "eye_in_hand" : "eye_to_hand";
}

Mounting other_mounting(Mounting mounting) {
  return mounting == Mounting::kEyeInHand ? Mounting::kEyeToHand : Mounting::kEyeInHand;
}

/// The poses the other way round. With them a camera on the flange and one beside the robot look
/// the same: X = base_from_flange for one is X = flange_from_base for the other.
PoseConvention inverse_of(PoseConvention convention) {
  const bool is_inverse = convention.direction == PoseDirection::kFlangeFromBase;
  convention.direction =
      is_inverse ? PoseDirection::kBaseFromFlange : PoseDirection::kFlangeFromBase;
  return convention;
}

/// The two readings that pictures cannot tell apart.
std::string either_reading(const CalibrateInput& input,
                           const PoseConvention& convention,
                           Mounting mounting) {
  const PoseConvention& taken = input.poses->convention;
  return fmt::format("{} --setup {}, or, which no picture distinguishes from it,{} --setup {}",
                     sets_between(taken, convention),
                     setup_name(mounting),
                     sets_between(taken, inverse_of(convention)),
                     setup_name(other_mounting(mounting)));
}

/// Whether poses and pictures agree; squares of another size are no matter of how poses are read.
bool agrees(const HandEyeCalibration& result) {
  return result.succeeded || result.has_other_squares;
}

/// The other setup, or the first other reading of the poses, that agrees with the pictures, and the
/// one that is the same to them; empty when none does.
std::string reading_that_agrees(const CalibrateInput& input, const HandEyeCalibration& failed) {
  if (!failed.camera.succeeded || failed.has_other_squares) {
    return {};
  }
  HandEyeOptions options = hand_eye_options(input, failed.mounting);
  options.camera.free_terms = failed.camera.is_free;
  options.mounting = other_mounting(failed.mounting);
  const std::vector<Isometry3d> poses = picture_poses(input, input.poses->convention);
  if (agrees(calibrate_hand_eye(input.corners, poses, options))) {
    return either_reading(input, input.poses->convention, options.mounting);
  }
  options.mounting = failed.mounting;
  for (const PoseConvention& other : input.poses->otherwise) {
    try {
      if (agrees(calibrate_hand_eye(input.corners, picture_poses(input, other), options))) {
        return either_reading(input, other, options.mounting);
      }
    } catch (const ConfigError&) {
      continue;  // read that way they are no motions
    }
  }
  return {};
}

/// "a.png to d.png", or of those that are not in a row "a.png, c.png and 5 more".
std::string names_text(const std::vector<std::string>& names, bool is_row) {
  constexpr std::size_t kShown = 3;
  if (is_row) {
    return fmt::format("{} to {}", names.front(), names.back());
  }
  const std::size_t shown = std::min(kShown, names.size());
  const std::vector<std::string> first(names.begin(),
                                       names.begin() + static_cast<std::ptrdiff_t>(shown));
  return fmt::format("{} and {} more", fmt::join(first, ", "), names.size() - shown);
}

/// The camera as the pictures have it where all of it was given as exact: without a free term they
/// cannot object. Else, and of fewer than three pictures, the solution itself.
Bundle freed(const Bundle& solved) {
  constexpr std::size_t kFreed = 5;  // fx fy cx cy k1
  constexpr std::size_t kMinFreedViews = 3;
  if (num_shared(solved) > 0 || solved.views.size() < kMinFreedViews) {
    return solved;
  }
  Bundle bundle = solved;
  std::fill_n(bundle.is_free.begin(), kFreed, true);
  return fit_camera(bundle, 6) ? bundle : solved;
}

double rms_of_views_px(const Bundle& bundle) {
  double squares = 0.0;
  double corners = 0.0;
  for (const BundleView& view : bundle.views) {
    const auto count = static_cast<double>(view.corners.board_mm.size());
    squares += count * std::pow(rms_px(bundle, view), 2);
    corners += count;
  }
  return std::sqrt(squares / corners);
}

/// Of a camera that was given as exact and is another one than the pictures'.
void warn_of_known_camera(const CameraCalibration& camera, std::vector<std::string>& warnings) {
  const Bundle free = freed(camera.bundle);
  const double known_px = rms_of_views_px(camera.bundle);
  const double free_px = rms_of_views_px(free);
  if (num_shared(camera.bundle) == 0 && free_px < 0.5 * known_px) {
    warnings.push_back(
        fmt::format("--camera: its numbers do not fit these pictures: they leave {:.3g} px (rms), "
                    "with other focal lengths, centre and k1 {:.3g} px would be left",
                    known_px,
                    free_px));
  }
}

/// @throws ConfigError when the pictures are of two cameras
void check_one_camera(const CalibrateInput& input, const CameraCalibration& camera) {
  const std::optional<SecondCamera> second = find_second_camera(freed(camera.bundle));
  if (!second) {
    return;
  }
  std::array<std::vector<std::string>, 2> names;
  std::size_t view = 0;
  for (std::size_t i = 0; i < camera.pictures.size(); ++i) {
    if (camera.pictures[i].accepted) {
      const std::size_t side = second->is_second[view++] ? 1 : 0;
      names[side].push_back(std::filesystem::path(input.names[i]).filename().string());
    }
  }
  const bool is_row = second->is_one_after_the_other();
  throw ConfigError(fmt::format(
      "the pictures are of two cameras, or of one whose lens was turned in between: {} agree among "
      "each other, and so do {}, with {:.3g} times the focal length; calibrate each by itself",
      names_text(names[0], is_row),
      names_text(names[1], is_row),
      second->focal_ratio));
}

/// Of a setup that was guessed. Beside the robot was tried second: poses the wrong way round look
/// so, too.
std::string note_of_setup(const CalibrateInput& input, Mounting mounting) {
  std::string note =
      fmt::format("setup = \"{}\": guessed, neither --setup nor the board's file says so",
                  setup_name(mounting));
  if (mounting == Mounting::kEyeToHand) {
    const PoseConvention& taken = input.poses->convention;
    note += fmt::format("; no picture distinguishes it from{} --setup {}",
                        sets_between(taken, inverse_of(taken)),
                        setup_name(other_mounting(mounting)));
  }
  return note;
}

/// What a refusal may owe to guesses; empty where nothing was guessed.
std::string guesses_text(const CalibrateInput& input) {
  const std::vector<std::string>& told = input.poses->told;
  return told.empty() ? std::string()
                      : fmt::format("; the poses were read with {}", fmt::join(told, "; "));
}

/// @throws ConfigError
HandEyeCalibration joint_calibration(const CalibrateInput& input, std::vector<std::string>& notes) {
  const std::vector<Isometry3d> poses = picture_poses(input, input.poses->convention);
  const bool is_open = input.setup == BoardSetup::kNone;
  const Mounting first =
      input.setup == BoardSetup::kEyeToHand ? Mounting::kEyeToHand : Mounting::kEyeInHand;
  HandEyeCalibration result =
      calibrate_hand_eye(input.corners, poses, hand_eye_options(input, first));
  if (result.camera.succeeded) {
    check_one_camera(input, result.camera);
  }
  if (!result.succeeded && is_open && result.camera.succeeded && !result.has_other_squares) {
    HandEyeCalibration other =
        calibrate_hand_eye(input.corners, poses, hand_eye_options(input, Mounting::kEyeToHand));
    if (agrees(other)) {
      result = std::move(other);
    }
  }
  if (!result.succeeded) {
    const std::string reading = reading_that_agrees(input, result);
    throw ConfigError(
        result.refusal +
        (reading.empty() ? std::string() : fmt::format("; they agree with{}", reading)) +
        guesses_text(input));
  }
  if (is_open) {
    notes.push_back(note_of_setup(input, result.mounting));
  }
  warn_of_known_camera(result.camera, result.warnings);
  std::ranges::copy(result.notes, std::back_inserter(notes));
  return result;
}

/// Of the board as it was solved, over the given one.
double board_size(const HandEyeCalibration& joint) {
  return joint.has_other_squares ? joint.scale.factor : 1.0;
}

Board resized(Board board, double size) {
  board.square_mm *= size;
  board.marker_mm *= size;
  return board;
}

/// The accepted pictures with the board turned as the calibration found it.
std::vector<PosePair> accepted_pairs(const CalibrateInput& input, const HandEyeCalibration& joint) {
  const HandEyeOptions options = hand_eye_options(input, joint.mounting);
  const double size = board_size(joint);
  BoardSymmetry symmetry{.turns = options.board_turns};
  symmetry.center_mm.head<2>() = size * *options.board_center_mm;
  const std::vector<Isometry3d> poses = picture_poses(input, input.poses->convention);
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < joint.pictures.size(); ++i) {
    if (joint.pictures[i].accepted) {
      Isometry3d camera_from_board = joint.camera.pictures[i].camera_from_board;
      camera_from_board.translation() *= size;
      pairs.push_back({.base_from_flange = poses[i],
                       .camera_from_board =
                           camera_from_board * board_turn(symmetry, joint.pictures[i].board_turn)});
    }
  }
  return pairs;
}

/// Each picture alone, or twenty parts of more pictures.
std::vector<int> prediction_folds(int count) {
  return count <= kMaxFolds ? leave_one_out(count) : shuffled_folds(count, kMaxFolds, 1);
}

void predict_all(const CalibrateInput& input, SolvedCalibration& solved, ThreadPool& pool) {
  const Bundle& bundle = solved.joint->bundle;
  const CameraOptions camera = camera_options(input);
  const int count = static_cast<int>(bundle.views.size());
  solved.prediction_folds = std::min(count, kMaxFolds);
  // Many pictures: a split says more, and takes longer.
  solved.five_fold_splits = input.five_fold_splits > 0
                                ? input.five_fold_splits
                                : std::clamp(400 / std::max(1, count), 4, 20);
  const auto left_out = predict_by_all(bundle, camera, prediction_folds(count), pool);
  const auto splits = predict_five_fold(bundle, camera, solved.five_fold_splits, pool);
  for (std::size_t i = 0; i < left_out.size(); ++i) {
    solved.methods.push_back(
        {.name = i == 0 ? "glint" : std::string(name_of(kHandEyeMethods[i - 1])),
         .has_failed = left_out[i].has_failed || splits[i].has_failed,
         .rms_px = left_out[i].rms_px,
         .five_fold = splits[i]});
    if (solved.methods.back().name == solved.method) {
      solved.predicted_rms_px = left_out[i].picture_rms_px;
    }
  }
}

void take_joint(SolvedCalibration& solved) {
  solved.lens = solved.joint->lens;
  solved.lens_sigma = solved.joint->lens_sigma();
  solved.poses = solved.joint->poses;
  solved.rms_px = solved.joint->rms_px;
}

void take_camera(SolvedCalibration& solved) {
  solved.lens = solved.camera.lens;
  solved.lens_sigma = solved.camera.sigma();
  solved.rms_px = solved.camera.rms_px;
}

void take_camera_prediction(const CalibrateInput& input,
                            SolvedCalibration& solved,
                            ThreadPool& pool) {
  if (std::ranges::count(solved.camera.is_free, true) == 0) {
    return;
  }
  std::vector<BoardCorners> accepted;
  for (std::size_t i = 0; i < input.corners.size(); ++i) {
    if (solved.camera.pictures[i].accepted) {
      accepted.push_back(input.corners[i]);
    }
  }
  const std::vector<int> folds = prediction_folds(static_cast<int>(accepted.size()));
  const Prediction prediction =
      predict_camera_left_out(accepted, solved.camera.lens, camera_options(input), folds, pool);
  solved.prediction_rms_px = prediction.rms_px;
  solved.prediction_folds = std::min(static_cast<int>(accepted.size()), kMaxFolds);
}

void advise(const CalibrateInput& input,
            const Bundle& bundle,
            const Board& board,
            SolvedCalibration& solved) {
  constexpr int kAdvisedViews = 3;
  solved.next =
      next_views(bundle, corners_mm(board), input.width_px, input.height_px, kAdvisedViews);
}

/// Which pictures pull, and what to photograph next. The views of a bundle are the accepted ones.
template <class Picture>
void review(const CalibrateInput& input,
            const Bundle& bundle,
            const std::vector<Picture>& pictures,
            SolvedCalibration& solved) {
  const std::vector<ViewInfluence> influences = view_influences(bundle);
  solved.influences.resize(pictures.size());
  std::size_t view = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (pictures[i].accepted) {
      solved.influences[i] = influences[view++];
    }
  }
  advise(input, bundle, solved.board, solved);
}

void solve_with_poses(const CalibrateInput& input, SolvedCalibration& solved, ThreadPool& pool) {
  solved.joint = joint_calibration(input, solved.notes);
  solved.board = resized(input.board, board_size(*solved.joint));
  solved.camera = solved.joint->camera;
  const std::vector<PosePair> pairs = accepted_pairs(input, *solved.joint);
  take_joint(solved);
  if (input.method) {
    const auto poses = hand_eye_by(*input.method, solved.joint->mounting, pairs);
    if (!poses) {
      throw ConfigError(
          fmt::format("--method {}: finds no hand-eye for these poses", name_of(*input.method)));
    }
    take_camera(solved);
    solved.method = std::string(name_of(*input.method));
    solved.poses = *poses;
  }
  solved.scatter = board_scatter(solved.joint->mounting, solved.poses.hand_eye, pairs);
  predict_all(input, solved, pool);
  if (input.method) {
    advise(input, solved.camera.bundle, input.board, solved);  // what it knows: the camera
  } else {
    review(input, solved.joint->bundle, solved.joint->pictures, solved);
  }
  solved.prediction_rms_px =
      std::ranges::find(solved.methods, solved.method, &MethodPrediction::name)->rms_px;
}

}  // namespace

SolvedCalibration solve_calibration(const CalibrateInput& input, ThreadPool& pool) {
  SolvedCalibration solved{.board = input.board};
  if (input.poses) {
    solve_with_poses(input, solved, pool);
    return solved;
  }
  solved.camera = calibrate_camera(input.corners, camera_options(input));
  if (!solved.camera.succeeded) {
    throw ConfigError(solved.camera.refusal);
  }
  check_one_camera(input, solved.camera);
  warn_of_known_camera(solved.camera, solved.camera.warnings);
  take_camera(solved);
  take_camera_prediction(input, solved, pool);
  review(input, solved.camera.bundle, solved.camera.pictures, solved);
  return solved;
}

}  // namespace glint
