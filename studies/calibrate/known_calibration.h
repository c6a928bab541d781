// SPDX-License-Identifier: GPL-3.0-or-later
//
// A calibration that was made before, from its calibration.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "hardware/board/board.h"
#include "hardware/calibration/bundle.h"
#include "hardware/calibration/lens_vector.h"
#include "hardware/calibration/pose_chain.h"
#include "hardware/poses/pose_convention.h"
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
  std::string closed_form;           ///< that the hand-eye is of, as --method names it; empty: none
  double rms_px = 0.0;               ///< of its own pictures
  std::optional<double> prediction_rms_px;
  /// Of the nine intrinsics, then with poses of the increments of hand-eye and board: 21 x 21, or
  /// 9 x 9 without poses and of closed forms. 0 x 0: not known.
  Eigen::MatrixXd covariance;
  NoiseSizes noise;  ///< of corners and robot; with poses
  /// How the poses' numbers were read; empty without poses, and of earlier versions.
  std::optional<PoseConvention> convention;
};

/// @param path  calibration.json or the folder that it is in
/// @throws ConfigError when it is none, IoError
KnownCalibration read_calibration(const std::filesystem::path& path);

/// The keys of a convention with nothing left open, for calibration.json.
nlohmann::ordered_json convention_json(PoseConvention convention);

/// A convention of calibration.json; empty where it has none.
/// @throws ConfigError, nlohmann::ordered_json::exception for what is none
std::optional<PoseConvention> convention_in(const nlohmann::ordered_json& calibration);

/// " --set convention.unit=m --set convention.direction=flange_from_base": what another reading of
/// poses has otherwise than the one that was taken; empty where they are the same.
std::string sets_between(const PoseConvention& taken, const PoseConvention& other);

}  // namespace glint
