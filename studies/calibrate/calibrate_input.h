// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint calibrate` is given: pictures of a board, robot poses, a camera that is known
// already.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "core/thread_pool.h"
#include "hardware/board/find_board.h"
#include "hardware/calibration/lens_vector.h"
#include "hardware/calibration/observations.h"
#include "hardware/calibration/opencv_methods.h"
#include "hardware/poses/camera_file.h"
#include "hardware/poses/pose_file.h"
#include "studies/definition/study.h"

namespace glint {

struct CalibrateOptions {
  std::vector<std::filesystem::path> pictures;
  /// Instead of pictures corners.csv of an earlier calibration; or its folder, of which what is not
  /// given beside it is taken, too (calibrate_run.h).
  std::filesystem::path from;
  std::filesystem::path board;       ///< board.toml or board.json
  std::optional<Board> known_board;  ///< where there is no file of it
  Board known_given;                 ///< known_board as its file has it: see KnownCalibration
  std::vector<std::filesystem::path> poses;  ///< empty: the camera alone
  bool are_known_poses = false;              ///< those of poses.toml of a folder in `from`
  /// How known poses were read from what the robot wrote; none: that is not on record.
  std::optional<PoseConvention> first_convention;
  std::filesystem::path camera;  ///< known intrinsics; empty: all are estimated
  std::filesystem::path out;     ///< empty: out/<the pictures' folder>/calibrate
  std::string setup;             ///< "eye_in_hand", "eye_to_hand"; empty: as the board's file says
  std::string method;            ///< of OpenCV's, name_of(HandEyeMethod); empty: our own
  /// convention.key, poses.pair_by, prior.key, over what files say; prediction.splits
  std::vector<KeyValue> sets;
  int threads = 1;
};

/// Everything that was read, with the boards found in the pictures.
struct CalibrateInput {
  Board board;                           ///< without its mark where the pictures do not show one
  Board given_board;                     ///< as it was given
  BoardSetup setup = BoardSetup::kNone;  ///< kNone with poses: to be found out
  std::optional<HandEyeMethod> method;   ///< none: our own
  std::optional<CameraFile> camera;
  std::optional<LensVector> camera_sigma;  ///< the camera is only known to these; none: exactly
  std::optional<RobotPoses> poses;
  /// How they were read from what the robot wrote: see CalibrateOptions::first_convention.
  std::optional<PoseConvention> convention;
  std::vector<std::size_t> pose_of;  ///< of each picture; empty without poses
  int width_px = 0;
  int height_px = 0;
  std::vector<std::string> names;     ///< of the pictures, as they were given
  std::vector<BoardView> views;       ///< of each picture
  std::vector<BoardCorners> corners;  ///< of each picture; no corners where it was not accepted
  std::vector<std::string> shown;     ///< of each picture, small, as report_png(); empty: none
  std::vector<std::string> notes;     ///< what was guessed
  int five_fold_splits = 0;           ///< of the prediction; 0: 20, fewer of many pictures
};

/// base_from_flange of each picture. @throws ConfigError where a pose cannot be read that way
std::vector<Eigen::Isometry3d> picture_poses(const CalibrateInput& input,
                                             const PoseConvention& convention);

/// Of what only reads poses. @throws ConfigError naming a key that says nothing of them
void check_sets_are_of_poses(const std::vector<KeyValue>& sets);

/// base_from_flange of each picture, without looking for boards.
/// @throws ConfigError, also for sets that are not of poses; IoError
std::vector<Eigen::Isometry3d> poses_of_pictures(const CalibrateOptions& options);

/// Reads what is small first, so that slips are told before pictures are searched.
/// With --from the corners are read instead of pictures.
/// @throws ConfigError  no pictures, no board's file, a board in none of the pictures, a larger one
///         in some, pictures of
///         different sizes, poses that do not pair, values with their places; IoError
CalibrateInput read_calibrate_input(const CalibrateOptions& options, ThreadPool& pool);

}  // namespace glint
