// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a calibration still holds: new pictures of the board against what it computes.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hardware/calibration/lens_vector.h"
#include "hardware/calibration/observations.h"
#include "hardware/calibration/robust_hand_eye.h"

namespace glint {

/// Root mean square of distances; 0 of none.
double rms_of(std::span<const Eigen::Vector2d> residuals_px);

/// Found minus computed at each corner; empty when a corner is not in front of the camera.
std::optional<std::vector<Eigen::Vector2d>> residuals_at(const LensVector& lens,
                                                         const Eigen::Isometry3d& camera_from_board,
                                                         const BoardCorners& corners);

/// The same with the board turned onto itself as it fits best.
std::optional<std::vector<Eigen::Vector2d>> residuals_at(const LensVector& lens,
                                                         const Eigen::Isometry3d& camera_from_board,
                                                         const BoardSymmetry& symmetry,
                                                         const BoardCorners& corners);

/// Degrees of freedom of a picture's residuals: the corners of one picture share the error of the
/// robot's pose, of which the camera sees a shift in two directions best. With a free pose they
/// share only what the board and the lens model lack.
inline constexpr int kFreedomsByRobot = 2;
inline constexpr int kFreedomsByFreePose = 20;

/// The rms from which on pictures say that the calibration has drifted, when they were expected to
/// have expected_px: the root of what chi-square over its degrees of freedom exceeds once in 1000
/// times.
/// @param freedoms  of all pictures, >= 1
double drift_limit_px(double expected_px, int freedoms);

/// Where the board lies by the pictures one by one, on base or flange: the mean. Needs one picture.
Eigen::Isometry3d board_seen(Mounting mounting,
                             const Eigen::Isometry3d& hand_eye,
                             std::span<const PosePair> pairs);

}  // namespace glint
