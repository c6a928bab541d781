// SPDX-License-Identifier: GPL-3.0-or-later
//
// Hand-eye and board pose in closed form, and from pictures of which some are wrong.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hardware/calibration/pose_chain.h"

namespace glint {

/// One picture: the robot's pose, and where the camera saw the board.
struct PosePair {
  Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
};

/// How a board can be mistaken for itself.
struct BoardSymmetry {
  int turns = 1;  ///< it looks the same after each 360/turns degrees; 1, 2 or 4
  Eigen::Vector3d center_mm = Eigen::Vector3d::Zero();  ///< on the board
  double radius_mm = 1.0;  ///< rms distance of the corners from the centre, > 0
};

/// board_from_turned_board: turn * 360 / turns degrees about the centre.
Eigen::Isometry3d board_turn(const BoardSymmetry& symmetry, int turn);

/// The method of Park and Martin: rotation by the polar decomposition of the sum of the rotation
/// vectors' products, then the translation by least squares, over all pairs; board as mean pose.
/// Empty with fewer than 3 pairs, or when all rotations are about one axis or none.
///
/// Source: F. Park, B. Martin, "Robot sensor calibration: solving AX = XB on the Euclidean group",
/// IEEE Trans. Robotics and Automation 10(5), 1994, with the sum's signs by SVD.
std::optional<HandEye> park(Mounting mounting, std::span<const PosePair> pairs);

/// Size of the board over the given one, by least squares of the translations of Park's method with
/// the size as a fourth unknown. Its standard deviation is taken as 10 % beforehand, so it is about
/// 1 where the motion says nothing of it; 1 for fewer than 3 pairs or rotations about one axis.
double board_size_by_motion(Mounting mounting, std::span<const PosePair> pairs);

/// How far the board's places scatter that the pictures one by one say, about their mean: roots of
/// the mean squares over the pictures, as ViSP's vpHandEyeCalibration prints them ("Mean residual
/// rMo").
struct BoardScatter {
  double rotation_rad = 0.0;    ///< rms angle
  double translation_mm = 0.0;  ///< rms distance of the board's origin
};

/// Residual of a hand-eye as ViSP's vpHandEyeCalibration reports it. It does not rank methods: the
/// pictures' own poses are often worse than the robot's.
/// @param pairs  not empty
BoardScatter board_scatter(Mounting mounting,
                           const Eigen::Isometry3d& hand_eye,
                           std::span<const PosePair> pairs);

/// A hand-eye that most pictures agree on.
struct RobustHandEye {
  HandEye poses;
  std::vector<int> turns;            ///< of each picture: 0 is what was detected
  std::vector<bool> is_inlier;       ///< agrees with the others
  std::vector<double> deviation_mm;  ///< rms of the board's corners from the common board
  double median_mm = 0.0;            ///< of the deviations
};

/// Tries Park's method on random subsets of five pictures, a subset's turns being those that make
/// camera and robot turn by equal angles, and takes what has the least median deviation; then again
/// from all inliers (deviation at most three times the median). The board's orientation is that of
/// the first inlier. Empty when no subset gives an answer.
/// Cost: O(subsets x pictures); about 20 ms for 80 pictures and 200 subsets.
std::optional<RobustHandEye> robust_hand_eye(Mounting mounting,
                                             std::span<const PosePair> pairs,
                                             const BoardSymmetry& symmetry,
                                             std::uint64_t seed);

}  // namespace glint
