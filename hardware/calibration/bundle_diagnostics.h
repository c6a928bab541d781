// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a joint calibration is worth: covariance, error of a projected point, size of the squares.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "hardware/calibration/bundle.h"

namespace glint {

/// Covariance of the nine intrinsics, the hand-eye's and the board's increments (rotation in rad,
/// translation in mm, both in the source's frame: hand_eye * motion_of(increment)). Rows and
/// columns of what is not estimated are zero.
using SharedCovariance = Eigen::Matrix<double, 21, 21>;

/// By the pictures' information with the robot's errors integrated out (shared_information()), the
/// bundle's noise sizes taken as known.
SharedCovariance shared_covariance(const Bundle& bundle);

/// The bundle with p1 and p2 as unknowns of 0 +- 5e-4 where they are left at 0: every lens has
/// some, and pictures too few to tell them take them for a turn of the camera and another centre.
/// As it is where the lens is known (no term is free, or there is a prior).
Bundle with_unseen(Bundle bundle);

/// shared_covariance(), where p1 and p2 are left at 0 with what that leaves open: with_unseen().
SharedCovariance covariance_with_unseen(const Bundle& bundle);

/// Standard deviation of the distance, in px, between the computed and the true place of a point.
struct PointError {
  double rms_px = 0.0;     ///< over the picture
  double center_px = 0.0;  ///< in the middle of the picture
  double edge_px = 0.0;    ///< in its corners, rms of the four
};

/// For points in the board's plane, given in its frame, seen from a robot pose without error: the
/// calibration's part of the error between a rendered and a real picture. The robot poses are those
/// of the pictures, the points those that fall on a grid of 7 x 7 pixels, the middle and the
/// corners.
PointError point_error(const Bundle& bundle,
                       const SharedCovariance& covariance,
                       int width_px,
                       int height_px);

/// The same at single pixels, rms over the pictures' poses; infinite where no ray meets the board's
/// plane.
std::vector<double> point_errors_px(const Bundle& bundle,
                                    const SharedCovariance& covariance,
                                    const Eigen::Vector2i& size_px,
                                    std::span<const Eigen::Vector2d> pixels_px);

/// How much larger the board is than it was given.
struct BoardScale {
  double factor = 1.0;  ///< true size over given size
  double sigma = 0.0;   ///< infinite: poses say nothing of it
  /// Covariance with the shared unknowns, over sigma: SharedCovariance holds for a known size and
  /// grows by coupling * coupling' where the size is estimated from the same pictures.
  Eigen::Matrix<double, 21, 1> coupling = Eigen::Matrix<double, 21, 1>::Zero();
};

/// One step of least squares with the size as a further unknown, from a solved joint bundle: right
/// to first order for factors near one. Pictures alone cannot tell a board's size, poses can.
BoardScale board_scale(const Bundle& bundle);

}  // namespace glint
