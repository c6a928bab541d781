// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/scatter.h"

#include <cmath>
#include <numbers>

namespace glint {
namespace {

/// Mean of |x| for a normal number of that mean and deviation, less |mean|.
double excess_of_absolute(double mean, double deviation) {
  constexpr double kFar = 5.0;
  const double z = std::abs(mean) / deviation;
  if (z > kFar) {
    return 0.0;
  }
  const double folded = deviation * std::sqrt(2.0 / std::numbers::pi) * std::exp(-0.5 * z * z);
  return folded - std::abs(mean) * std::erfc(z / std::numbers::sqrt2);
}

}  // namespace

Homogeneity with_scatter(const Homogeneity& homogeneity,
                         const ImageF& aspect,
                         const ImageF& deviation,
                         const Mask& region) {
  if (homogeneity.mean <= 0.0) {
    return homogeneity;
  }
  double count = 0.0;
  double variance = 0.0;
  double absolute = 0.0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region.values()[i] == 0) {
      continue;
    }
    count += 1.0;
    const auto sigma = static_cast<double>(deviation.values()[i]);
    if (sigma > 0.0) {
      variance += sigma * sigma;
      const double rest = static_cast<double>(aspect.values()[i]) - homogeneity.mean;
      absolute += excess_of_absolute(rest, sigma);
    }
  }
  Homogeneity result = homogeneity;
  if (count > 0.0) {
    const double sigma = (1.0 - homogeneity.h_rms) * homogeneity.mean;
    result.h_rms = 1.0 - std::sqrt(sigma * sigma + variance / count) / homogeneity.mean;
    result.h_abs -= absolute / count / homogeneity.mean;
  }
  return result;
}

}  // namespace glint
