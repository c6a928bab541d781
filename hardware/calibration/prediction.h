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

/// Solves all folds but one, noise sizes included, and predicts the pictures left out without any
/// error of the robot; for each fold in turn.
///
/// The pictures are the accepted ones, the lens terms those chosen from all of them; everything
/// else is estimated within the fold.
/// @param solved  a joint bundle at its solution, where each fold starts
/// @param folds   of each view, 0, 1, 2, ...
Prediction predict_left_out(const Bundle& solved, std::span<const int> folds, ThreadPool& pool);

/// The same for one of OpenCV's methods: the camera alone from the other folds' pictures, then the
/// method. Rejected pictures and turned boards are those that our own calibration found.
Prediction predict_left_out(const Bundle& solved,
                            std::span<const int> folds,
                            HandEyeMethod method,
                            ThreadPool& pool);

}  // namespace glint
