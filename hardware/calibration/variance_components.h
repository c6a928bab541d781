// SPDX-License-Identifier: GPL-3.0-or-later
//
// How large corner noise and robot errors are, from the data alone.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "hardware/calibration/bundle.h"

namespace glint {

/// What all pictures say about the shared unknowns and the noise near a solution, compressed.
///
/// Near a solution the residuals y of a picture are normal with mean -J d, d the step of the shared
/// unknowns. With S the covariance of the robot's error and L how the corners move with it, L = Q R
/// splits y into the six numbers Q'y, which the error reaches, with covariance t^2 I + R S R', t
/// the noise of patterns, and the rest, which it does not reach, with covariance s^2 I, s the
/// corner noise.
struct CompressedBundle {
  struct View {
    Vector6d reached = Vector6d::Zero();                 ///< Q'y, px
    Eigen::Matrix<double, 6, Eigen::Dynamic> by_shared;  ///< Q'J
    Eigen::Matrix<double, 6, 6> by_error;                ///< R
  };

  std::vector<View> views;
  Eigen::MatrixXd rest_hessian;   ///< sum of J'(I - QQ')J
  Eigen::VectorXd rest_gradient;  ///< sum of J'(I - QQ')y
  double rest_square_px2 = 0.0;   ///< sum of y'(I - QQ')y
  double rest_count = 0.0;        ///< rows of the rest
};

/// The compressed form at the bundle's state.
/// @throws nothing; a picture with corners behind the camera is left out
CompressedBundle compress(const Bundle& bundle);

/// Information about the shared unknowns with these noise sizes, pictures' errors integrated out.
struct SharedInformation {
  Eigen::MatrixXd hessian;                ///< inverse covariance
  Eigen::VectorXd gradient;               ///< of minus the logarithm of the likelihood
  double minus_two_log_likelihood = 0.0;  ///< restricted: of what no step of the unknowns explains
};

SharedInformation shared_information(const Bundle& bundle,
                                     const CompressedBundle& compressed,
                                     const NoiseSizes& noise);

/// Inverse of a Hessian whose unknowns have different units. Directions without information get a
/// variance of 1e16 times that of the best known one in units of the diagonal, not an error.
Eigen::MatrixXd inverse_information(const Eigen::MatrixXd& hessian);

/// Noise sizes, and how well they are known.
struct EstimatedNoise {
  NoiseSizes noise;
  /// Standard deviations of the logarithms of corner_px, robot_rad, robot_mm.
  Eigen::Vector3d log_sigma = Eigen::Vector3d::Zero();
};

/// The sizes that maximise the restricted likelihood (variance components), found by Newton's
/// method on their logarithms from the bundle's sizes. Without limits of the robot's errors
/// (NoiseSizes 0) only the corner noise is estimated, as rms over degrees of freedom.
/// Sizes are at least 1e-5 px, 1e-7 rad, 1e-5 mm, so that perfect data can be solved; the noise of
/// patterns is s sqrt(1 + w^2) with w free, so that it is at least the corner noise s.
///
/// Source: D. A. Harville, "Maximum likelihood approaches to variance component estimation", JASA
/// 72(358), 1977; the compression is our own.
/// Cost: O(views p^2) an evaluation, p the shared unknowns; about 100 evaluations.
EstimatedNoise estimate_noise(const Bundle& bundle);

}  // namespace glint
