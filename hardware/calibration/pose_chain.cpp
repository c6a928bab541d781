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
      board_(poses.board * motion_of(increment.board)),
      error_(motion_of(increment.error)),
      robot_(base_from_flange),
      hand_eye_(poses.hand_eye * motion_of(increment.hand_eye)),
      board_turn_(poses.board.linear()),
      board_jacobian_(right_jacobian(increment.board.head<3>())),
      error_jacobian_(right_jacobian(increment.error.head<3>())),
      hand_eye_jacobian_(right_jacobian(increment.hand_eye.head<3>())),
      hand_eye_step_(rotation_of(increment.hand_eye.head<3>())) {}

Vector3d PoseChain::point_in_camera_mm(const Vector3d& point_on_board_mm,
                                       Derivatives* derivatives) const {
  const bool in_hand = mounting_ == Mounting::kEyeInHand;
  const Vector3d outer = board_ * point_on_board_mm;
  // The error is the second link for an eye-in-hand camera, the first one otherwise.
  const Vector3d before = in_hand ? robot_.inverse() * outer : outer;
  const Vector3d moved = in_hand ? error_.inverse() * before : error_ * before;
  const Vector3d after = in_hand ? moved : robot_ * moved;
  const Vector3d point = hand_eye_.inverse() * after;
  if (derivatives == nullptr) {
    return point;
  }
  const Matrix3d from_error =  // of what leaves the link of the error
      in_hand ? Matrix3d(hand_eye_.linear().transpose())
              : Matrix3d(hand_eye_.linear().transpose() * robot_.linear());
  const Matrix3d from_outer =
      in_hand ? Matrix3d(from_error * error_.linear().transpose() * robot_.linear().transpose())
              : Matrix3d(from_error * error_.linear());
  derivatives->by_hand_eye << cross_matrix(point) * hand_eye_jacobian_, -hand_eye_step_.transpose();
  derivatives->by_board << -from_outer * board_.linear() * cross_matrix(point_on_board_mm) *
                               board_jacobian_,
      from_outer * board_turn_;
  if (in_hand) {
    derivatives->by_error << from_error * cross_matrix(moved) * error_jacobian_,
        -from_error * error_.linear().transpose();
  } else {
    derivatives->by_error << -from_error * error_.linear() * cross_matrix(before) * error_jacobian_,
        from_error;
  }
  return point;
}

Isometry3d PoseChain::camera_from_board() const {
  const Isometry3d flange_from_base = (robot_ * error_).inverse();
  const Isometry3d middle =
      mounting_ == Mounting::kEyeInHand ? flange_from_base : Isometry3d(robot_ * error_);
  return hand_eye_.inverse() * middle * board_;
}

Isometry3d camera_from_board(Mounting mounting,
                             const HandEye& poses,
                             const Isometry3d& base_from_flange) {
  return PoseChain(mounting, poses, base_from_flange, {}).camera_from_board();
}

}  // namespace glint
