// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/bisection.h"

#include <cmath>

#include "core/error.h"

namespace glint {

SmallestDetectable smallest_detectable(const std::function<double(double)>& figure,
                                       double low,
                                       double high,
                                       double target,
                                       const BisectionSettings& settings) {
  GLINT_CHECK(low > 0.0 && high > low, "sizes rise from above 0");
  GLINT_CHECK(settings.relative_step > 0.0 && settings.most_calls >= 3, "a step and three calls");
  const double at_low = figure(low);
  if (at_low >= target) {
    return {.result = Detectable::kAlready, .size = low, .figure = at_low};
  }
  SmallestDetectable best = {.result = Detectable::kNever, .size = high, .figure = figure(high)};
  if (!(best.figure >= target)) {
    return best;
  }
  best.result = Detectable::kFound;
  for (int calls = 2; calls < settings.most_calls; ++calls) {
    if (best.size <= low * (1.0 + settings.relative_step)) {
      break;
    }
    const double middle = std::sqrt(low * best.size);
    const double value = figure(middle);
    if (value >= target) {
      best.size = middle;
      best.figure = value;
    } else {
      low = middle;
    }
  }
  return best;
}

}  // namespace glint
