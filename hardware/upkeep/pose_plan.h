// SPDX-License-Identifier: GPL-3.0-or-later
//
// From where to photograph a board, before a camera is known well.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hardware/calibration/bundle.h"
#include "simulator/camera/pinhole_camera.h"

namespace glint {

struct PlanRequest {
  PinholeIntrinsics camera;                 ///< roughly known
  std::vector<Eigen::Vector3d> board_mm;    ///< corners that are measured, in view and in focus
  std::vector<Eigen::Vector3d> outline_mm;  ///< what else of the board must be so; may be empty
  int count = 20;                           ///< of poses, >= 1
  double near_mm = 0.0;                     ///< in focus from here, along the view
  /// To here. Of these two 0: where the board fills 90, 40 % of the picture, within ...; where the
  /// other one lies beyond that, 1.5 times as near, as far.
  double far_mm = 0.0;
  double sharp_near_mm = 0.0;  ///< ... what the lens shows sharp; 0: not known
  double sharp_far_mm = std::numeric_limits<double>::infinity();
  double tilt_min_rad = 0.35;  ///< of the board against the view; one pose in eight is not tilted
  double tilt_max_rad = 0.52;
  double roll_rad = 0.7;    ///< about the view, to both sides
  double margin_px = 10.0;  ///< that the board keeps from the picture's border
  std::uint64_t seed = 1;
  LensMask is_free = {true, true, true, true, true, true, true, true, true};  ///< is estimated
  NoiseSizes noise;
  Mounting mounting = Mounting::kEyeInHand;
  HandEye poses;                         ///< what the poses say hardly depends on it
  std::vector<Eigen::Isometry3d> taken;  ///< board_from_camera of pictures that there are already
  /// What the hand-eye is to be known to, of its three numbers together, with_unseen() counted;
  /// 0: not asked for; with neither all unknowns count alike.
  double aim_rad = 0.0;
  double aim_mm = 0.0;
};

/// Standard deviations of a hand-eye: roots of the sums of the three axes' variances.
struct HandEyeSigma {
  double rad = 0.0;
  double mm = 0.0;
};

/// Poses in the order to take them.
struct PosePlan {
  std::vector<Eigen::Isometry3d> board_from_camera;
  /// Standard deviations that the poses promise, with the pictures that there are.
  LensVector lens_sigma = LensVector::Zero();
  double hand_eye_rad = 0.0;  ///< root of the sum of the three axes' variances
  double hand_eye_mm = 0.0;
  HandEyeSigma before;  ///< with pictures that there are: what these tell, with_unseen() counted
  std::vector<HandEyeSigma> after;  ///< with each pose and those before it; else empty
  double near_mm = 0.0;             ///< the distances that were tried
  double far_mm = 0.0;
};

/// Out of 600 random poses that show the whole board in focus those are taken, one after another,
/// that add most to what the pictures that there are tell of intrinsics, hand-eye and board (greedy
/// D-optimal design), or with an aim shrink the hand-eye's variances most, in units of the aim
/// (A-optimal), so that any first part of the plan is a good plan, too.
/// @throws ConfigError when hardly any pose shows the whole board, or the distances leave none
PosePlan informative_poses(const PlanRequest& request);

/// The same ranges, cut evenly: distance, tilt and the axis that it is about, roll and place in the
/// picture on a grid, of which every n-th that shows the whole board is taken; then shuffled.
/// @throws ConfigError likewise
PosePlan strided_poses(const PlanRequest& request);

}  // namespace glint
