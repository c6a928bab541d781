// SPDX-License-Identifier: GPL-3.0-or-later
//
// What pictures of a board and a robot's poses come to before a calibration: plain arrays.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace glint {

/// The corners of a board that were found in one picture.
struct BoardCorners {
  std::vector<Eigen::Vector3d> board_mm;    ///< on the board, z = 0
  std::vector<Eigen::Vector2d> picture_px;  ///< same length; (0, 0) is the outer corner of a pixel
};

}  // namespace glint
