// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/error_bound.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "metrics/statistics/quantiles.h"

namespace glint {

ErrorBound error_bound(std::span<const double> errors, double content, double confidence) {
  GLINT_CHECK(errors.size() >= 2, "a bound takes at least two errors");
  GLINT_CHECK(content > 0.0 && content < 1.0, "the content of a bound lies in (0, 1)");
  GLINT_CHECK(std::ranges::all_of(errors, [](double error) { return std::isfinite(error); }),
              "errors are finite");
  const auto n = static_cast<double>(errors.size());
  ErrorBound result;
  for (const double error : errors) {
    result.bias += error / n;
  }
  double squares = 0.0;
  for (const double error : errors) {
    squares += (error - result.bias) * (error - result.bias);
  }
  result.spread = std::sqrt(squares / (n - 1.0));
  result.bound =
      std::abs(result.bias) + tolerance_factor(errors.size(), content, confidence) * result.spread;
  return result;
}

double tolerance_factor(std::size_t count, double content, double confidence) {
  GLINT_CHECK(count >= 2, "a bound takes at least two errors");
  GLINT_CHECK(content > 0.0 && content < 1.0, "the content of a bound lies in (0, 1)");
  const auto n = static_cast<double>(count);
  const double shift = normal_quantile(0.5 * (1.0 + content)) * std::sqrt(n);
  return std::max(noncentral_t_quantile(confidence, n - 1.0, shift) / std::sqrt(n), 0.0);
}

double prediction_factor(std::size_t count, double confidence) {
  GLINT_CHECK(count >= 2, "a bound takes at least two errors");
  const auto n = static_cast<double>(count);
  return t_quantile(0.5 * (1.0 + confidence), n - 1.0) * std::sqrt(1.0 + 1.0 / n);
}

}  // namespace glint
