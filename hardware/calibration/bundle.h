// SPDX-License-Identifier: GPL-3.0-or-later
//
// All pictures of a calibration together: unknowns, noise sizes, and the linear system that the
// residuals become near a solution.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hardware/calibration/lens_vector.h"
#include "hardware/calibration/observations.h"
#include "hardware/calibration/pose_chain.h"

namespace glint {

/// Standard deviations of independent errors.
struct NoiseSizes {
  double corner_px = 0.2;   ///< of a corner along one axis
  double robot_rad = 3e-4;  ///< of a robot pose's rotation about one axis; 0: no limit
  double robot_mm = 0.05;   ///< of a robot pose's place along one axis; 0: no limit
  /// Of the six patterns in a picture's corners that a movement of the board would make, each of
  /// length one over all corners. Errors that neighbours share (a board that is not flat, blur,
  /// what the lens model lacks) look like movements, so this is at least corner_px; 0: equal to it.
  double pattern_px = 0.0;

  double whole_pattern_px() const { return std::max(corner_px, pattern_px); }
};

/// One picture.
struct BundleView {
  BoardCorners corners;
  Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();
  Vector6d error = Vector6d::Zero();  ///< of the robot's pose, rad and mm; an unknown
  Eigen::VectorXd weights;            ///< of the corners, 0 to 1
  /// 2 m x 6, orthonormal: how the weighted corners move with the error; empty: pattern_px is not
  /// looked at by the minimiser. take_patterns() sets it.
  Eigen::MatrixXd patterns;
};

/// What is known of the intrinsics beforehand: independent normal distributions.
struct LensPrior {
  LensVector mean = LensVector::Zero();
  LensVector sigma = LensVector::Zero();  ///< infinite: nothing is known; > 0
};

/// The unknowns of all pictures.
///
/// Without robot poses each picture has a free pose of its own: hand-eye and board stay the
/// identity (are_poses_free false), base_from_flange is the inverse of the picture's
/// camera_from_board, and the errors have no limit (NoiseSizes 0).
struct Bundle {
  Mounting mounting = Mounting::kEyeInHand;
  LensVector lens = LensVector::Zero();
  LensMask is_free = {};  ///< which intrinsics may move
  std::optional<LensPrior> lens_prior;
  HandEye poses;
  bool are_poses_free = false;
  NoiseSizes noise;
  std::vector<BundleView> views;
};

/// The same unknowns with no pictures.
Bundle without_views(const Bundle& bundle);

/// Residuals (computed minus found, px, corner by corner x then y) of one picture and how they
/// move.
struct ViewSystem {
  Eigen::VectorXd residual_px;  ///< 2 m
  Eigen::Matrix<double, Eigen::Dynamic, 9> by_lens;
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_hand_eye;
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_board;
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_error;
};

/// Evaluates a picture with the poses moved by an increment; the increment's error replaces the
/// view's. Not weighted.
/// @param system  overwritten
/// @param with_derivatives  false: only residual_px
/// @return false when a corner is not in front of the camera; system is then of no use
bool evaluate_view(const Bundle& bundle,
                   const BundleView& view,
                   const LensVector& lens,
                   const ChainIncrement& increment,
                   bool with_derivatives,
                   ViewSystem& system);

/// Number of the unknowns that all pictures share: free intrinsics, then hand-eye, board.
int num_shared(const Bundle& bundle);

/// The system of a picture at the bundle's state with weighted rows and the columns of the shared
/// unknowns in one matrix. Empty when a corner is not in front of the camera.
struct WeightedSystem {
  Eigen::VectorXd residual_px;
  Eigen::MatrixXd by_shared;  ///< 2 m x num_shared()
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_error;
};

std::optional<WeightedSystem> weighted_system(const Bundle& bundle, const BundleView& view);

/// An orthonormal base of the columns of by_error.
Eigen::MatrixXd patterns_of(const WeightedSystem& system);

/// Sets the patterns of all views at the bundle's state, or empties them when pattern_px is not
/// larger than corner_px.
void take_patterns(Bundle& bundle);

/// Adds what the prior knows of the free intrinsics to the normal equations of the shared unknowns.
/// @param hessian, gradient  of minus the logarithm of the likelihood
void add_lens_prior(const Bundle& bundle, Eigen::MatrixXd& hessian, Eigen::VectorXd& gradient);

/// Root mean square of the distances between found and computed corners; infinite when a corner
/// is not in front of the camera.
double rms_px(const Bundle& bundle, const BundleView& view);

}  // namespace glint
