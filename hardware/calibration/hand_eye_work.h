// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the steps of calibrate_hand_eye() share.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "hardware/calibration/hand_eye_calibration.h"
#include "hardware/calibration/variance_components.h"

namespace glint {

/// A hand-eye calibration on its way.
struct HandEyeWork {
  std::span<const BoardCorners> pictures;
  std::span<const Eigen::Isometry3d> base_from_flange;
  HandEyeOptions options;
  HandEyeCalibration result;
  BoardSymmetry symmetry;           ///< at the size
  std::vector<std::size_t> seen;    ///< pictures that the camera's calibration accepted
  std::vector<PosePair> pairs;      ///< of those, at the size
  double distance_mm = 1.0;         ///< median from the camera to the board
  double size = 1.0;                ///< of the board as it is assumed, over the given one
  bool is_size_free = false;        ///< the size is estimated, too
  bool has_known_noise = false;     ///< few pictures: the start's sizes of the errors are kept
  bool has_disagreed = false;       ///< the first solution rejected many pictures
  std::vector<BoardCorners> sized;  ///< the pictures with the board at the size
  EstimatedNoise estimated;
};

}  // namespace glint
