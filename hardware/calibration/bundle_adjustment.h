// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one place where Ceres is called.
#pragma once

#include "hardware/calibration/bundle.h"

namespace glint {

/// How a minimisation ended.
struct AdjustmentSummary {
  bool has_converged = false;
  int iterations = 0;
  double cost = 0.0;  ///< half the sum of squares, in units of the noise sizes
};

/// Moves the free intrinsics, the poses and each view's error to the least sum of
/// weights |residual / corner_px|^2 (pattern_px along the views' patterns) + |error / robot|^2 +
/// |(lens - mean) / sigma|^2.
///
/// Levenberg-Marquardt with the views' errors eliminated (Schur complement), analytic derivatives,
/// one thread: same input, same bytes. Nothing moves when a corner is behind the camera at the
/// start. Cost: per iteration O(corners) + O(views).
AdjustmentSummary adjust_bundle(Bundle& bundle);

}  // namespace glint
