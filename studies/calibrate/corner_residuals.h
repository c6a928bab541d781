// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a calibration leaves over at the corners, and where in the picture.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "studies/calibrate/calibrate_input.h"
#include "studies/calibrate/solved_calibration.h"

namespace glint {

/// Whether a picture takes part in the calibration.
bool is_used(const SolvedCalibration& solved, std::size_t picture);

/// Found minus computed, of each picture each corner. With poses by the joint solution with the
/// most likely error of the robot; of rejected pictures, and of a closed form that was asked for,
/// with a free pose of the picture. No numbers where no such pose was found.
std::vector<std::vector<Eigen::Vector2d>> corner_residuals_px(const CalibrateInput& input,
                                                              const SolvedCalibration& solved);

/// Residuals of the pictures used in one rectangle of the picture.
struct ResidualCell {
  int corners = 0;
  Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();
  double rms_px = 0.0;  ///< of the distances
};

/// The picture in cols x rows equal rectangles, row by row.
struct ResidualMap {
  int cols = 0;
  int rows = 0;
  std::vector<ResidualCell> cells;
};

ResidualMap residual_map(const CalibrateInput& input,
                         const SolvedCalibration& solved,
                         const std::vector<std::vector<Eigen::Vector2d>>& residuals_px);

/// A ring about the picture's middle.
struct ErrorRing {
  double from_px = 0.0;
  double to_px = 0.0;
  int corners = 0;
  double rms_px = 0.0;  ///< of the residuals of the pictures used
  /// Standard deviation of a computed point within the ring: with poses point_errors_px(), without,
  /// or with a closed form, ray_errors_px(). Infinite: unknown.
  double error_px = 0.0;
};

/// Five rings of equal width from the middle to the picture's corners.
std::vector<ErrorRing> error_rings(const CalibrateInput& input,
                                   const SolvedCalibration& solved,
                                   const std::vector<std::vector<Eigen::Vector2d>>& residuals_px);

}  // namespace glint
