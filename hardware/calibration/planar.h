// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one picture of a flat board says in closed form: homography, focal lengths, pose.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hardware/calibration/lens_vector.h"
#include "hardware/calibration/observations.h"

namespace glint {

/// The matrix that takes (x, y, 1) on the board to the picture, by least squares of the algebraic
/// error in normalised coordinates. Empty with fewer than 4 corners or corners on one line.
///
/// Source: R. Hartley, A. Zisserman, "Multiple View Geometry", 2nd ed., algorithm 4.2.
std::optional<Eigen::Matrix3d> homography(const BoardCorners& corners);

/// (fx, fy) from homographies to the picture, the principal point being known and no skew. Empty
/// when the views say nothing, as when all show the board squarely.
///
/// Source: Z. Zhang, "A flexible new technique for camera calibration", IEEE TPAMI 22(11), 2000,
/// equations (3) and (4), with the principal point known.
std::optional<Eigen::Vector2d> focal_px(std::span<const Eigen::Matrix3d> homographies,
                                        const Eigen::Vector2d& center_px);

/// camera_from_board from the homography of the undistorted corners; a start for a refinement.
/// Empty as homography(), or when a corner cannot be undistorted.
std::optional<Eigen::Isometry3d> board_pose(const BoardCorners& corners, const LensVector& lens);

}  // namespace glint
