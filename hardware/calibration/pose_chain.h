// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a point on the board over the robot to the camera, with derivatives.
//
//   camera on the flange: camera_from_board = inv(flange_from_camera) inv(base_from_flange E)
//                                             base_from_board
//   camera beside the robot: camera_from_board = inv(base_from_camera) base_from_flange E
//                                                flange_from_board
//
// E is the error of the robot's pose, a small motion of the flange. The first factor is called
// hand-eye, the last one board, in both cases.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hardware/calibration/rotation.h"

namespace glint {

/// Where camera and board are fixed.
enum class Mounting {
  kEyeInHand,  ///< camera on the flange, board in the cell
  kEyeToHand   ///< camera in the cell, board on the flange
};

/// The two poses that a hand-eye calibration looks for.
struct HandEye {
  Eigen::Isometry3d hand_eye = Eigen::Isometry3d::Identity();  ///< flange_ or base_from_camera
  Eigen::Isometry3d board = Eigen::Isometry3d::Identity();     ///< base_ or flange_from_board
};

/// Increments: hand_eye * motion_of(hand_eye), board * motion_of(board), and the robot's error.
struct ChainIncrement {
  Vector6d hand_eye = Vector6d::Zero();
  Vector6d board = Vector6d::Zero();
  Vector6d error = Vector6d::Zero();
};

/// Takes points of the board to the camera in one picture.
class PoseChain {
 public:
  /// How a point in the camera's frame moves with the increments.
  struct Derivatives {
    Eigen::Matrix<double, 3, 6> by_hand_eye;
    Eigen::Matrix<double, 3, 6> by_board;
    Eigen::Matrix<double, 3, 6> by_error;
  };

  PoseChain(Mounting mounting,
            const HandEye& poses,
            const Eigen::Isometry3d& base_from_flange,
            const ChainIncrement& increment);

  /// @param derivatives  not null: receives the derivatives at the increment
  Eigen::Vector3d point_in_camera_mm(const Eigen::Vector3d& point_on_board_mm,
                                     Derivatives* derivatives) const;

  Eigen::Isometry3d camera_from_board() const;

 private:
  Mounting mounting_;
  // A point goes from the board to the link of the robot's error, over the error, and to the
  // camera.
  Eigen::Isometry3d before_;         ///< from the board, with its increment
  Eigen::Isometry3d error_;          ///< E, or its inverse for a camera on the flange
  Eigen::Isometry3d after_;          ///< to the camera, with the increment of the hand-eye
  Eigen::Matrix3d from_board_;       ///< rotation from the board, with its increment, to the camera
  Eigen::Matrix3d from_board_step_;  ///< from the board before its increment
  Eigen::Matrix3d from_error_step_;  ///< from the error's translation
  Eigen::Matrix3d board_jacobian_;
  Eigen::Matrix3d error_jacobian_;
  Eigen::Matrix3d hand_eye_jacobian_;
  Eigen::Matrix3d hand_eye_step_;  ///< rotation of the hand-eye's increment
};

/// camera_from_board with these poses and no error of the robot.
Eigen::Isometry3d camera_from_board(Mounting mounting,
                                    const HandEye& poses,
                                    const Eigen::Isometry3d& base_from_flange);

/// The other way round: base_from_flange where the camera sees the board so.
Eigen::Isometry3d flange_that_sees(Mounting mounting,
                                   const HandEye& poses,
                                   const Eigen::Isometry3d& camera_from_board);

}  // namespace glint
