// SPDX-License-Identifier: GPL-3.0-or-later
//
// A camera from pictures of a flat board, without a robot.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hardware/calibration/bundle.h"
#include "hardware/calibration/lens_vector.h"
#include "hardware/calibration/observations.h"

namespace glint {

/// Intrinsics that are known beforehand.
struct KnownLens {
  LensVector lens = LensVector::Zero();
  /// Standard deviations; 0: exact, infinite: only a start. Not given: all exact.
  std::optional<LensVector> sigma;
};

struct CameraOptions {
  int width_px = 0;   ///< > 0
  int height_px = 0;  ///< > 0
  std::optional<KnownLens> known;
  /// Which terms are estimated. Not given: chosen by held-out prediction.
  std::optional<LensMask> free_terms;
  int folds = 5;           ///< for the choice of terms, >= 2
  std::uint64_t seed = 1;  ///< which picture belongs to which fold
};

/// One picture in a calibration.
struct CalibratedPicture {
  bool accepted = false;
  std::string reason;   ///< why it is rejected; empty when it is accepted
  double rms_px = 0.0;  ///< of the distances between found and computed corners; infinite: none
  Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
};

/// A set of lens terms and how well it predicts pictures that it was not fitted to.
struct LensChoice {
  std::string name;  ///< "k1 k2 p1 p2", "no distortion"
  LensMask is_free = {};
  double held_out_rms_px = 0.0;  ///< infinite: could not be fitted
  /// Standard error of the difference of the mean squares to the best choice, px^2.
  double standard_error_px2 = 0.0;
};

struct CameraCalibration {
  bool succeeded = false;
  std::string refusal;                ///< what is missing; empty when it succeeded
  std::vector<std::string> warnings;  ///< what is weak
  int width_px = 0;
  int height_px = 0;
  LensVector lens = LensVector::Zero();
  LensMask is_free = {};
  Eigen::Matrix<double, 9, 9> covariance = Eigen::Matrix<double, 9, 9>::Zero();
  double rms_px = 0.0;            ///< over all corners of the accepted pictures
  double corner_sigma_px = 0.0;   ///< of a corner along one axis, degrees of freedom counted
  double largest_tilt_rad = 0.0;  ///< between the board's normal and the view
  std::vector<CalibratedPicture> pictures;  ///< as many as observations
  std::vector<LensChoice> choices;          ///< those tried; empty when the terms were given
  Bundle bundle;  ///< what was solved: the accepted pictures in their order

  LensVector sigma() const { return covariance.diagonal().cwiseSqrt(); }

  PinholeIntrinsics intrinsics() const { return intrinsics_from(lens, width_px, height_px); }
};

/// Homographies, focal lengths by Zhang's method, then least squares over intrinsics and one pose
/// per picture with weights that limit single wrong corners to 3 sigma.
///
/// A picture is rejected when it has fewer than 6 corners, its corners lie on a line, or its rms is
/// over five times the median. Refused: no size of the picture, fewer than 3 accepted pictures when
/// the focal length is not known (1 else), or a focal length that stays unknown by more than 5 %.
/// Cost: about 0.1 s for 80 pictures of 80 corners, 2 s with a choice of terms.
CameraCalibration calibrate_camera(std::span<const BoardCorners> pictures,
                                   const CameraOptions& options);

}  // namespace glint
