// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well a figure tells things with from things without: receiver operating characteristic.
#pragma once

#include <span>
#include <vector>

#include "metrics/statistics/estimate.h"

namespace glint {

/// Area under the curve: P(with > without) + P(equal) / 2, with DeLong's variance on the logit
/// scale; where that variance is 0 (areas 0 and 1 among them) with Newcombe's score interval.
/// @param with, without  not empty
Estimate area_under_roc(std::span<const double> with,
                        std::span<const double> without,
                        double confidence = 0.95);

}  // namespace glint
