// SPDX-License-Identifier: GPL-3.0-or-later
//
// A real camera on, or beside, a real robot: intrinsics, hand-eye and board from pictures of a
// board and the robot's poses, and how well they are known.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hardware/calibration/bundle_diagnostics.h"
#include "hardware/calibration/camera_calibration.h"
#include "hardware/calibration/motion_geometry.h"
#include "hardware/calibration/robust_hand_eye.h"

namespace glint {

/// What settles which corner of the board is the first.
enum class BoardOrientation {
  kMark,         ///< a mark on the board
  kPattern,      ///< the pattern itself: an odd and an even number of corners, or codes
  kFirstPicture  ///< nothing on the board: it lies as it was detected in the first accepted picture
};

struct HandEyeOptions {
  Mounting mounting = Mounting::kEyeInHand;
  CameraOptions camera;
  /// After how many turns of 360 degrees / board_turns the board looks the same: 1 for a board with
  /// a mark, with codes, or with an odd and an even number of corners; 2 for other checkerboards; 4
  /// for square ones with an even number.
  int board_turns = 1;
  bool has_mark = false;   ///< only what is said of the orientation depends on it
  double square_mm = 0.0;  ///< only what is said of the board's size depends on it; 0: not known
  /// Middle of the board; not given: of all corners that were found anywhere.
  std::optional<Eigen::Vector2d> board_center_mm;
  std::uint64_t seed = 1;  ///< of the random subsets
  /// Of the pictures, for what is said of one; empty: their numbers, counted from 1.
  std::vector<std::string> names;
};

/// One picture with its robot pose.
struct HandEyePicture {
  bool accepted = false;
  std::string reason;   ///< why it is rejected; empty when it is accepted
  double rms_px = 0.0;  ///< with the most likely error of the robot; infinite: none found
  int board_turn = 0;   ///< by how many turns the board was taken for itself
  /// How badly its robot pose agrees with the others: chi-square of 6 degrees of freedom, whose
  /// mean is 6 when all is well.
  double chi_square = 0.0;
  Vector6d robot_error = Vector6d::Zero();  ///< most likely, in the flange's frame, rad and mm
  int fits_pose_of = -1;  ///< rejected: the other picture whose robot pose would fit; -1: none
};

struct HandEyeCalibration {
  bool succeeded = false;
  std::string refusal;                ///< what is missing; empty when it succeeded
  std::vector<std::string> warnings;  ///< what is weak or odd
  std::vector<std::string> notes;     ///< what was found out and taken into account
  Mounting mounting = Mounting::kEyeInHand;
  CameraCalibration camera;              ///< from the pictures without the poses
  LensVector lens = LensVector::Zero();  ///< from all together
  HandEye poses;
  SharedCovariance covariance = SharedCovariance::Zero();
  SharedCovariance with_unseen = SharedCovariance::Zero();    ///< covariance_with_unseen()
  NoiseSizes noise;                                           ///< estimated
  Eigen::Vector3d noise_log_sigma = Eigen::Vector3d::Zero();  ///< of their logarithms
  double rms_px = 0.0;  ///< over all corners of the accepted pictures
  std::vector<HandEyePicture> pictures;
  BoardOrientation orientation = BoardOrientation::kPattern;
  MotionGeometry motion;
  PointError point;
  /// By one further step of least squares; with has_other_squares that of the solution.
  BoardScale scale;
  /// The board is solved, or refused, at the size that the robot's motion says: bundle, poses and
  /// covariance, not camera, are those of a board scale.factor times as large as given.
  bool has_other_squares = false;
  Bundle bundle;  ///< what was solved, for predictions: the accepted pictures in their order

  PinholeIntrinsics intrinsics() const {
    return intrinsics_from(lens, camera.width_px, camera.height_px);
  }

  LensVector lens_sigma() const { return covariance.diagonal().head<9>().cwiseSqrt(); }

  /// Roots of the sums of the three axes' variances, with what p1 and p2 leave open.
  double rotation_sigma_rad() const {
    return std::sqrt(with_unseen.diagonal().segment<3>(9).sum());
  }

  double translation_sigma_mm() const {
    return std::sqrt(with_unseen.diagonal().segment<3>(12).sum());
  }
};

/// The camera alone (calibrate_camera()), a robust hand-eye (robust_hand_eye()), then least squares
/// over intrinsics, hand-eye, board and six numbers of robot error per picture, whose sizes are
/// estimated from the data (estimate_noise()). Pictures that do not agree with their robot pose are
/// rejected, and all are tried again after each solution.
///
/// Where that rejects pictures or finds another size of the board likely, all is solved again with
/// the size free. A size that is clearly off (3 sigma and 0.03 %) is taken and noted up to 0.5 %,
/// so that no picture is rejected for it, and refused beyond.
///
/// Without the robot's errors among the unknowns 0.05 degrees of the robot, which are pixels at the
/// board, would be pushed into the principal point.
///
/// Refused: other numbers of pictures and poses, poses that are no rigid motions, what
/// refusal_of(MotionGeometry) says, a hand-eye that stays unknown by more than 1 degree or 5 % of
/// the distance, poses that contradict the pictures by more than 3 degrees or 5 % of it, a board or
/// a camera that moved between two pictures (find_moved_board()), squares of another size.
/// @param pictures, base_from_flange  equally many
/// @throws nothing for bad data
/// Cost: about 0.3 s for 80 pictures of 80 corners, and the choice of terms.
HandEyeCalibration calibrate_hand_eye(std::span<const BoardCorners> pictures,
                                      std::span<const Eigen::Isometry3d> base_from_flange,
                                      const HandEyeOptions& options);

}  // namespace glint
