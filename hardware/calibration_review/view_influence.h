// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pictures pull at a calibration.
#pragma once

#include <vector>

#include "hardware/calibration/bundle.h"

namespace glint {

/// How far the solution moves when one picture is left out, sizes of all errors staying as they
/// are.
struct ViewInfluence {
  /// Cook's distance: the squared move in units of the covariance, over the number of unknowns.
  /// Of n equal pictures about 1 / n; over 1 the picture alone moves all by a standard deviation.
  double cook = 0.0;
  double rotation_rad = 0.0;    ///< of the hand-eye; 0 without poses
  double translation_mm = 0.0;  ///< of the hand-eye; 0 without poses
  double focal_px = 0.0;        ///< the larger of the two focal lengths' moves
  double center_px = 0.0;       ///< of the principal point
};

/// Of each view of a solved bundle, by one step of least squares from the solution: exact where the
/// residuals are linear. Infinite where nothing can be solved without the picture.
///
/// Source: R. D. Cook, "Detection of influential observation in linear regression", Technometrics
/// 19(1), 1977.
/// Cost: O(views).
std::vector<ViewInfluence> view_influences(const Bundle& solved);

}  // namespace glint
