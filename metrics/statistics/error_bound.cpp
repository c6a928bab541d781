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
  const double shift = normal_quantile(0.5 * (1.0 + content)) * std::sqrt(n);
  const double factor = noncentral_t_quantile(confidence, n - 1.0, shift) / std::sqrt(n);
  result.bound = std::abs(result.bias) + std::max(factor, 0.0) * result.spread;
  return result;
}

}  // namespace glint
