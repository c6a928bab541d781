// SPDX-License-Identifier: GPL-3.0-or-later
//
// What to photograph next.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hardware/calibration/bundle.h"

namespace glint {

/// A view of the board that is worth a picture.
struct NextView {
  Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
  std::optional<Eigen::Isometry3d> base_from_flange;  ///< with poses: where the robot has to be
  double tilt_rad = 0.0;                              ///< of the board against the picture's plane
  /// Towards the nearest side of the board, in the picture: 0 right, pi / 2 down.
  double near_side_rad = 0.0;
  double roll_rad = 0.0;  ///< about the optical axis, against the mean of the pictures
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();  ///< where the board's middle is seen
  double distance_mm = 0.0;                             ///< to it
  double point_error_px = 0.0;  ///< expected with this view and those before it
};

struct ViewAdvice {
  double point_error_px = 0.0;  ///< now: one sigma of a computed point, rms over the picture
  std::vector<NextView> views;  ///< the best first
};

/// Of candidate views that show the whole board (tilts of 0, 15 and 30 degrees to eight sides, four
/// rolls, nine places in the picture, three distances about the median) those that shrink the error
/// of computed points most, one after the other: the largest part of the covariance in pixels.
/// With poses the error is that of hand-eye, board and intrinsics together, without that of the
/// intrinsics at a fixed pose.
/// @param solved  a bundle at its solution, with its sizes of errors
/// @param board_mm  all corners of the board
/// Cost: about 1 ms a candidate, 2000 candidates.
ViewAdvice next_views(const Bundle& solved,
                      const std::vector<Eigen::Vector3d>& board_mm,
                      int width_px,
                      int height_px,
                      int count);

/// "tilted by 30 degrees, upper left side nearest, rolled by 90 degrees, ...".
std::string text_of(const NextView& view, int width_px, int height_px);

}  // namespace glint
