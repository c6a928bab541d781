// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/estimate.h"

#include <cmath>
#include <numbers>

namespace glint {

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

}  // namespace glint
