// SPDX-License-Identifier: GPL-3.0-or-later
//
// Probability of detection against defect size, from hits and misses: logit model by maximum
// likelihood, as MIL-HDBK-1823A and ASTM E2862 have it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "metrics/statistics/estimate.h"

namespace glint {

struct SizedTrial {
  double size = 0.0;  ///< > 0
  bool is_hit = false;
};

struct PodFit {
  double intercept = 0.0;  ///< logit(POD) = intercept + slope ln(size)
  double slope = 0.0;
  double variance_intercept = 0.0;  ///< of the estimates, from the Fisher information
  double variance_slope = 0.0;
  double covariance = 0.0;
  double a50 = 0.0;  ///< size found half the time
  /// Size found nine times of ten, with its two-sided interval from the profile of Firth's
  /// penalised likelihood (the plain one is too narrow). Where the trials do not tell, low is 0 or
  /// high infinite.
  Estimate a90;
  double a90_95 = 0.0;  ///< the size found nine times of ten with 95 % confidence; may be infinite

  /// With the two-sided interval at one size. @param size  > 0
  Estimate at(double size, double confidence = 0.95) const;
};

/// Empty when the likelihood has no maximum (all hit, all missed, or separated by size) or falls
/// with size. Trials must be independent. @param trials  sizes > 0
std::optional<PodFit> fit_pod(std::span<const SizedTrial> trials, double confidence = 0.95);

}  // namespace glint
