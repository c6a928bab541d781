// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/bisection.h"

#include <cmath>

#include "core/error.h"

namespace glint {

SmallestDetectable smallest_detectable(const std::function<double(double)>& statistic,
                                       double low,
                                       double high,
                                       double target,
                                       const BisectionSettings& settings) {
  GLINT_CHECK(low > 0.0 && high > low, "sizes rise from above 0");
  GLINT_CHECK(settings.relative_step > 0.0 && settings.max_calls >= 3, "a step and three calls");
  const double at_low = statistic(low);
  if (at_low >= target) {
    return {.result = Detectable::kAlready, .size = low, .statistic = at_low};
  }
  SmallestDetectable best = {
      .result = Detectable::kNever, .size = high, .statistic = statistic(high)};
  if (!(best.statistic >= target)) {
    return best;
  }
  best.result = Detectable::kFound;
  for (int calls = 2; calls < settings.max_calls; ++calls) {
    if (best.size <= low * (1.0 + settings.relative_step)) {
      break;
    }
    const double middle = std::sqrt(low * best.size);
    const double value = statistic(middle);
    if (value >= target) {
      best.size = middle;
      best.statistic = value;
    } else {
      low = middle;
    }
  }
  return best;
}

}  // namespace glint
