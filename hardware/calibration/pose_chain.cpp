// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/pose_chain.h"

namespace glint {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

PoseChain::PoseChain(Mounting mounting,
                     const HandEye& poses,
                     const Isometry3d& base_from_flange,
                     const ChainIncrement& increment)
    : mounting_(mounting),
      board_jacobian_(right_jacobian(increment.board.head<3>())),
      error_jacobian_(right_jacobian(increment.error.head<3>())),
      hand_eye_jacobian_(right_jacobian(increment.hand_eye.head<3>())),
      hand_eye_step_(rotation_of(increment.hand_eye.head<3>())) {
  const Isometry3d board = poses.board * motion_of(increment.board);
  const Isometry3d error = motion_of(increment.error);
  const Isometry3d camera = (poses.hand_eye * motion_of(increment.hand_eye)).inverse();
  // The error is the second link for an eye-in-hand camera, the first one otherwise.
  const bool in_hand = mounting == Mounting::kEyeInHand;
  before_ = in_hand ? base_from_flange.inverse() * board : board;
  error_ = in_hand ? error.inverse() : error;
  after_ = in_hand ? camera : camera * base_from_flange;
  from_board_ = after_.linear() * error_.linear() * before_.linear();
  from_board_step_ = from_board_ * rotation_of(increment.board.head<3>()).transpose();
  from_error_step_ = in_hand ? Matrix3d(-after_.linear() * error_.linear()) : after_.linear();
}

Vector3d PoseChain::point_in_camera_mm(const Vector3d& point_on_board_mm,
                                       Derivatives* derivatives) const {
  const Vector3d before = before_ * point_on_board_mm;
  const Vector3d moved = error_ * before;
  Vector3d point = after_ * moved;
  if (derivatives == nullptr) {
    return point;
  }
  derivatives->by_hand_eye << cross_matrix(point) * hand_eye_jacobian_, -hand_eye_step_.transpose();
  derivatives->by_board << -from_board_ * (cross_matrix(point_on_board_mm) * board_jacobian_),
      from_board_step_;
  if (mounting_ == Mounting::kEyeInHand) {
    derivatives->by_error << after_.linear() * (cross_matrix(moved) * error_jacobian_),
        from_error_step_;
  } else {
    derivatives->by_error << -after_.linear() * error_.linear() *
                                 (cross_matrix(before) * error_jacobian_),
        from_error_step_;
  }
  return point;
}

Isometry3d PoseChain::camera_from_board() const {
  return after_ * error_ * before_;
}

Isometry3d camera_from_board(Mounting mounting,
                             const HandEye& poses,
                             const Isometry3d& base_from_flange) {
  return PoseChain(mounting, poses, base_from_flange, {}).camera_from_board();
}

Isometry3d flange_that_sees(Mounting mounting,
                            const HandEye& poses,
                            const Isometry3d& camera_from_board) {
  return mounting == Mounting::kEyeInHand
             ? poses.board * camera_from_board.inverse() * poses.hand_eye.inverse()
             : poses.hand_eye * camera_from_board * poses.board.inverse();
}

}  // namespace glint
