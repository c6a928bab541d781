// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well a calibration predicts pictures that it has not seen, from the robot's pose alone.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/thread_pool.h"
#include "hardware/calibration/bundle.h"
#include "hardware/calibration/camera_calibration.h"
#include "hardware/calibration/opencv_methods.h"

namespace glint {

/// Distances between found and predicted corners.
struct Prediction {
  bool has_failed = false;             ///< some fold could not be solved, or predicts nothing
  double rms_px = 0.0;                 ///< over all corners; infinite when it has failed
  double median_px = 0.0;              ///< of the pictures' rms
  std::vector<double> picture_rms_px;  ///< of each of the bundle's views
};

/// Fold of each picture when each is left out alone: 0, 1, 2, ...
std::vector<int> leave_one_out(int count);

/// Solves all folds but one and predicts the pictures left out without any error of the robot; for
/// each fold in turn. Lens terms are chosen, noise sizes and everything else estimated within the
/// fold; only which pictures are accepted is known from all of them.
/// @param solved  a joint bundle at its solution, where each fold starts
/// @param camera  of the calibration: which terms may be estimated, or which are given
/// @param folds   of each view, 0, 1, 2, ...
Prediction predict_left_out(const Bundle& solved,
                            const CameraOptions& camera,
                            std::span<const int> folds,
                            ThreadPool& pool);

/// The same for our own solution and then for OpenCV's methods in the order of kHandEyeMethods: the
/// camera alone from the other folds' pictures, with the terms chosen there, then the method.
/// Rejected pictures and turned boards are those that our own calibration found.
std::vector<Prediction> predict_by_all(const Bundle& solved,
                                       const CameraOptions& camera,
                                       std::span<const int> folds,
                                       ThreadPool& pool);

/// Without a robot: solves the camera from all folds but one, terms chosen within, and predicts the
/// corners of the pictures left out, whose own poses alone are fitted.
/// @param pictures  those that a calibration has accepted
/// @param lens  where each fold starts
Prediction predict_camera_left_out(std::span<const BoardCorners> pictures,
                                   const LensVector& lens,
                                   const CameraOptions& camera,
                                   std::span<const int> folds,
                                   ThreadPool& pool);

/// Mean over splits of a prediction's rms.
struct SplitMean {
  bool has_failed = false;    ///< in some split
  double rms_px = 0.0;        ///< infinite when it has failed
  double deviation_px = 0.0;  ///< standard deviation of the splits' rms
};

/// predict_by_all() in `splits` random splits in five parts, seeds 1, 2, ...
/// Cost: 5 * splits solutions, and as many choices of the lens terms.
std::vector<SplitMean> predict_five_fold(const Bundle& solved,
                                         const CameraOptions& camera,
                                         int splits,
                                         ThreadPool& pool);

}  // namespace glint
