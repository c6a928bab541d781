// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of calibration boards whose corners are known exactly.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Geometry>

#include "core/image/image_io.h"
#include "core/rng.h"
#include "hardware/board/board.h"
#include "simulator/camera/pinhole_camera.h"

namespace glint {

/// How a board is photographed.
struct BoardScene {
  Board board;
  PinholeIntrinsics camera;
  Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
  /// Standard deviation of the blur at a depth in mm, px; empty: 0.5 everywhere.
  std::function<double(double)> blur_px_at;
  double white = 0.8;  ///< share of full scale
  double black = 0.15;
  double shading = 0.2;      ///< how much darker the left border is than the right one
  double noise = 2.0 / 255;  ///< of a pixel, share of full scale
  bool has_clutter = true;   ///< soft grey spots around the board, else white
};

/// The board as the camera sees it: each pixel the mean of 4 x 4 points of black and white squares,
/// dots and markers, blurred by Gaussians, with noise, in 8 bits. The board has a white border of
/// one square.
Image<std::uint8_t> photographed(const BoardScene& scene, Rng& rng);

/// Where the board's corners appear, row by row; must be in front of the camera.
std::vector<Eigen::Vector2d> true_corners_px(const BoardScene& scene);

/// How far inside the picture the outermost corner lies, negative when the board is cut.
double corners_inside_px(const BoardScene& scene);

/// The largest blur at any corner, px, with the pixel's own.
double largest_blur_px(const BoardScene& scene);

/// A pose with the board tilted by up to tilt_rad about both axes and rolled by up to roll_rad, its
/// middle at that distance and off the optical axis by up to shift_mm.
Eigen::Isometry3d random_pose(const Board& board,
                              double distance_mm,
                              double tilt_rad,
                              double roll_rad,
                              double shift_mm,
                              Rng& rng);

/// Root mean square distance of corners to the true ones, whichever symmetric board fits better.
double rms_px(const Board& board,
              const std::vector<Eigen::Vector2d>& found,
              const std::vector<Eigen::Vector2d>& truth);

}  // namespace glint
