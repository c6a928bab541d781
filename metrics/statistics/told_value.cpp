// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/told_value.h"

#include <algorithm>
#include <cmath>

#include "metrics/statistics/quantiles.h"

namespace glint {

Estimate told_value(std::span<const double> values,
                    double error,
                    std::optional<ModelledScore> model) {
  constexpr double kUpper = 0.975;
  const auto n = static_cast<double>(values.size());
  const double mean = mean_of(values).value;
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - mean) * (value - mean);
  }
  const double variance = std::max(squares / (n - 1.0), error * error);
  if (variance <= 0.0) {
    return {.value = mean, .low = mean, .high = mean};
  }
  double weight = n / variance;
  double value = mean;
  if (model) {
    const double of_model = 1.0 / (model->sd * model->sd + variance);
    value = (weight * mean + of_model * model->mean) / (weight + of_model);
    weight += of_model;
  }
  const double half = t_quantile(kUpper, n - 1.0) / std::sqrt(weight);
  return {.value = value, .low = value - half, .high = value + half};
}

}  // namespace glint
