// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a noisy score is on average over random numbers, by all that is known of it.
#pragma once

#include <optional>
#include <span>

#include "metrics/statistics/estimate.h"

namespace glint {

/// What a model expects of a score, for the random numbers that it was told values with.
struct ModelledScore {
  double mean = 0.0;
  double sd = 0.0;  ///< >= 0
};

/// The score with its 95 % interval: from evaluations that nothing was chosen by, and from what a
/// model expects, weighted by what each knows. One evaluation scatters by as much as they do among
/// themselves, and by no less than the score itself says; the model's random numbers are off by as
/// much as one evaluation (docs/theory/search.md, "The last word under noise"; own derivation).
/// @param values  two or more
/// @param error   standard error of one evaluation that the score tells; 0: none
Estimate told_value(std::span<const double> values,
                    double error,
                    std::optional<ModelledScore> model = {});

}  // namespace glint
