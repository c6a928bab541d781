// SPDX-License-Identifier: GPL-3.0-or-later
//
// A calibration that was made before, from its calibration.json.
#pragma once

#include <filesystem>
#include <optional>

#include <Eigen/Core>

#include "hardware/board/board.h"
#include "hardware/calibration/bundle.h"
#include "hardware/calibration/lens_vector.h"
#include "hardware/calibration/pose_chain.h"
#include "simulator/camera/pinhole_camera.h"

namespace glint {

struct KnownCalibration {
  std::filesystem::path file;
  PinholeIntrinsics intrinsics;
  LensMask is_free = {};  ///< which intrinsics were estimated
  Board board;
  Board given_board;  ///< as its file had it: squares before they were measured, a missing mark
  std::optional<Mounting> mounting;  ///< with poses
  HandEye poses;                     ///< with a mounting
  double rms_px = 0.0;               ///< of its own pictures
  std::optional<double> prediction_rms_px;
  /// Of the nine intrinsics, then with poses of the increments of hand-eye and board: 21 x 21, or
  /// 9 x 9 without poses and of closed forms. 0 x 0: not known.
  Eigen::MatrixXd covariance;
  NoiseSizes noise;  ///< of corners and robot; with poses
};

/// @param path  calibration.json or the folder that it is in
/// @throws ConfigError when it is none, IoError
KnownCalibration read_calibration(const std::filesystem::path& path);

}  // namespace glint
