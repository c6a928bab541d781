// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/config/pose_keys.h"
#include "studies/calibration_trial/trial_poses.h"

namespace glint::test {

inline const Board kBoard = {.cols = 10, .rows = 8, .square_mm = 6.6};

/// A camera of 1224 x 1025 pixels, 150 mm from a board.
inline CameraOnRobot camera_on_robot(CalibrationSetup setup = CalibrationSetup::kEyeInHand) {
  return {.intrinsics = {.width_px = 1224,
                         .height_px = 1025,
                         .focal_px = {1895.0, 1893.0},
                         .center_px = {615.3, 508.6},
                         .radial = {-0.1, 0.05, 0.0},
                         .tangential = {1e-3, -8e-4}},
          .setup = setup,
          .hand_eye = transform_of(
              {.translation_mm = {12.0, -58.0, 84.0}, .rotation_vector_rad = {0.01, -0.02, 0.8}}),
          .board = transform_of(
              {.translation_mm = {420.0, -110.0, 60.0}, .rotation_vector_rad = {3.0, 0.1, 0.3}})};
}

}  // namespace glint::test
