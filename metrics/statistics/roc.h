// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well a figure tells things with from things without: receiver operating characteristic.
#pragma once

#include <span>
#include <vector>

#include "metrics/statistics/estimate.h"

namespace glint {

struct RocPoint {
  double threshold = 0.0;     ///< figures at or above it count as found
  double false_alarms = 0.0;  ///< share of the things without, in [0, 1]
  double hits = 0.0;          ///< share of the things with, in [0, 1]
};

/// From (0, 0) to (1, 1), one point for each distinct figure. @param with, without  not empty
std::vector<RocPoint> roc(std::span<const double> with, std::span<const double> without);

/// Area under it: P(with > without) + P(equal) / 2, with DeLong's variance on the logit scale;
/// where that variance is 0 (areas 0 and 1 among them) with Newcombe's score interval.
/// @param with, without  not empty
Estimate area_under_roc(std::span<const double> with,
                        std::span<const double> without,
                        double confidence = 0.95);

}  // namespace glint
