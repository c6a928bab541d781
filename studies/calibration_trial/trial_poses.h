// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a robot takes camera or board to for the pictures of a trial, and where it says it is.
#pragma once

#include <cstdint>
#include <optional>

#include "core/pose.h"
#include "hardware/board/board.h"
#include "simulator/camera/pinhole_camera.h"
#include "studies/definition/calibration_trial_settings.h"
#include "studies/definition/cell_settings.h"

namespace glint {

/// What a calibration looks for.
struct CameraOnRobot {
  PinholeIntrinsics intrinsics;
  CalibrationSetup setup = CalibrationSetup::kEyeInHand;
  RigidTransform hand_eye;  ///< flange_from_camera, or base_from_camera
  RigidTransform board;     ///< base_from_board, or flange_from_board
};

RigidTransform camera_from_board(const CameraOnRobot& truth,
                                 const RigidTransform& base_from_flange);

/// The pose of the flange at which the camera sees the board so. @param view  camera from board
RigidTransform base_from_flange(const CameraOnRobot& truth, const RigidTransform& view);

/// One picture's pose of the flange.
struct TrialPose {
  RigidTransform told;  ///< what the robot says
  RigidTransform real;  ///< told, then the robot's error in the flange's frame
};

/// Draws a view of the whole board; the same seed and index give the same pose. Tilts, roll, shift
/// and distance are uniform within their limits, the robot's errors normal.
/// @param index  of the picture
/// @throws ConfigError with the key at fault when the board does not fit into the picture
TrialPose draw_pose(const CameraOnRobot& truth,
                    const Board& board,
                    const CalibrationTrialSettings& settings,
                    std::uint64_t index);

}  // namespace glint
