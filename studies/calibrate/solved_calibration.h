// SPDX-License-Identifier: GPL-3.0-or-later
//
// From what was read to a camera and, with poses, a hand-eye; and how well they predict pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "hardware/calibration/hand_eye_calibration.h"
#include "hardware/calibration_review/next_views.h"
#include "hardware/calibration_review/prediction.h"
#include "hardware/calibration_review/view_influence.h"
#include "studies/calibrate/calibrate_input.h"

namespace glint {

/// How a way to the hand-eye predicts pictures that it has not seen.
struct MethodPrediction {
  std::string name;  ///< "glint", or name_of(HandEyeMethod)
  bool has_failed = false;
  double rms_px = 0.0;  ///< infinite when it has failed
  SplitMean five_fold;  ///< mean over random splits in five parts
};

struct SolvedCalibration {
  /// As it was given; with poses that say that its squares are a little larger or smaller, so.
  Board board;
  CameraCalibration camera;                 ///< from the pictures alone
  std::optional<HandEyeCalibration> joint;  ///< with poses
  LensVector lens = LensVector::Zero();     ///< what is written: joint, or the camera's own
  LensVector lens_sigma = LensVector::Zero();
  std::string method = "glint";  ///< that was asked for
  HandEye poses;                 ///< of the method that was asked for
  BoardScatter scatter;          ///< of the board's places that the pictures say one by one
  double rms_px = 0.0;
  int prediction_folds = 0;                 ///< 0: there is no prediction
  std::optional<double> prediction_rms_px;  ///< of the method that was asked for
  std::vector<double> predicted_rms_px;  ///< with poses: of each picture used, when it is left out,
                                         ///< by the method that was asked for
  int five_fold_splits = 0;              ///< 0: without poses
  std::vector<MethodPrediction> methods;  ///< with poses: our own, then OpenCV's
  std::vector<ViewInfluence> influences;  ///< of each picture; 0 where it is rejected; not of a
                                          ///< method of OpenCV
  ViewAdvice next;                        ///< what to photograph next
  std::vector<std::string> notes;         ///< what was guessed
};

/// @throws ConfigError with what is missing, or with the reading of the poses that would agree
SolvedCalibration solve_calibration(const CalibrateInput& input, ThreadPool& pool);

}  // namespace glint
