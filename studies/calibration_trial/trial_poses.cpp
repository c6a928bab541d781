// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibration_trial/trial_poses.h"

#include <algorithm>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/rng.h"

namespace glint {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

/// Corners stay this far from the picture's border: share of its width, and pixels that a corner's
/// window needs.
constexpr double kBorder = 0.02;
constexpr double kBorder_px = 12.0;

Vector3d middle_mm(const Board& board) {
  return 0.5 * (corner_mm(board, 0, 0) + corner_mm(board, board.cols - 1, board.rows - 1));
}

/// Board and camera have the same axes when the board is seen straight and upright.
RigidTransform draw_view(const Board& board, const CalibrationTrialSettings& settings, Rng& rng) {
  const double tilt_x = rng.uniform(-settings.tilt_rad, settings.tilt_rad);
  const double tilt_y = rng.uniform(-settings.tilt_rad, settings.tilt_rad);
  const double roll = rng.uniform(-settings.roll_rad, settings.roll_rad);
  const Vector3d middle(rng.uniform(-settings.shift_mm, settings.shift_mm),
                        rng.uniform(-settings.shift_mm, settings.shift_mm),
                        settings.distance_mm.at(rng.uniform()));
  RigidTransform view;
  view.rotation = (AngleAxisd(roll, Vector3d::UnitZ()) * AngleAxisd(tilt_x, Vector3d::UnitX()) *
                   AngleAxisd(tilt_y, Vector3d::UnitY()))
                      .toRotationMatrix();
  view.translation_mm = middle - view.rotation * middle_mm(board);
  return view;
}

bool is_whole(const PinholeCamera& camera, const Board& board, const RigidTransform& view) {
  const PinholeIntrinsics& in = camera.intrinsics();
  const double border_px = std::max(kBorder * in.width_px, kBorder_px);
  return std::ranges::all_of(corners_mm(board), [&](const Vector3d& corner) {
    const auto at = camera.project(view * corner);
    return at && at->x() > border_px && at->y() > border_px && at->x() < in.width_px - border_px &&
           at->y() < in.height_px - border_px;
  });
}

Vector3d normal_vector(double sigma, Rng& rng) {
  const double x = rng.normal();
  const double y = rng.normal();
  const double z = rng.normal();
  return sigma * Vector3d(x, y, z);
}

RigidTransform draw_robot_error(const CalibrationTrialSettings& settings, std::uint64_t index) {
  Rng rng(static_cast<std::uint64_t>(settings.seed), Stream::kRobotErrors, index);
  const Vector3d turn = normal_vector(settings.robot_sigma_rad, rng);
  RigidTransform error = {.translation_mm = normal_vector(settings.robot_sigma_mm, rng)};
  if (turn.norm() > 0.0) {
    error.rotation = AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  }
  return error;
}

}  // namespace

RigidTransform camera_from_board(const CameraOnRobot& truth, const RigidTransform& flange) {
  const RigidTransform robot =
      truth.setup == CalibrationSetup::kEyeInHand ? inverse(flange) : flange;
  return inverse(truth.hand_eye) * robot * truth.board;
}

RigidTransform base_from_flange(const CameraOnRobot& truth, const RigidTransform& view) {
  const RigidTransform robot = truth.hand_eye * view * inverse(truth.board);
  return truth.setup == CalibrationSetup::kEyeInHand ? inverse(robot) : robot;
}

TrialPose draw_pose(const CameraOnRobot& truth,
                    const Board& board,
                    const CalibrationTrialSettings& settings,
                    std::uint64_t index) {
  constexpr int kTries = 1000;
  const PinholeCamera camera(truth.intrinsics);
  Rng rng(static_cast<std::uint64_t>(settings.seed), Stream::kBoardPoses, index);
  for (int i = 0; i < kTries; ++i) {
    const RigidTransform view = draw_view(board, settings, rng);
    if (is_whole(camera, board, view)) {
      const RigidTransform told = base_from_flange(truth, view);
      return {.told = told, .real = told * draw_robot_error(settings, index)};
    }
  }
  throw ConfigError(
      "calibration_trial.distance_mm",
      fmt::format("the board of {} x {} corners fits into the picture in none of {} views; greater "
                  "distances, smaller tilts or less shift show the whole of it",
                  board.cols,
                  board.rows,
                  kTries));
}

}  // namespace glint
