// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/appearance/unclipped_pixels.h"

#include <algorithm>
#include <cmath>

#include "metrics/appearance/grey_sums.h"

namespace glint {
namespace {

constexpr double kClearOfNoise = 2.0;  ///< deviations
constexpr double kMinClear = 0.02;
constexpr double kMaxClear = 0.2;
constexpr int kNearPx = 2;  ///< neighbours: so far along rows and columns

/// Mean of a pixel and its neighbours in the picture.
double mean_near(const ImageF& grey, std::size_t pixel) {
  const int x = static_cast<int>(pixel) % grey.width();
  const int y = static_cast<int>(pixel) / grey.width();
  double sum = 0.0;
  double count = 0.0;
  for (int v = std::max(y - kNearPx, 0); v <= std::min(y + kNearPx, grey.height() - 1); ++v) {
    for (int u = std::max(x - kNearPx, 0); u <= std::min(x + kNearPx, grey.width() - 1); ++u) {
      sum += static_cast<double>(grey(u, v));
      count += 1.0;
    }
  }
  return sum / count;
}

GreySums sums_of(const ImageF& simulated, const ImageF& real, const Mask& shown) {
  GreySums sums;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (shown.values()[i] != 0) {
      sums.add(static_cast<double>(simulated.values()[i]), static_cast<double>(real.values()[i]));
    }
  }
  return sums;
}

}  // namespace

std::vector<std::size_t> unclipped_pixels(const ImageF& simulated,
                                          const ImageF& real,
                                          const Mask& shown,
                                          const UnclippedOptions& options) {
  std::vector<std::size_t> pixels;
  const GreySums sums = sums_of(simulated, real, shown);
  if (!(sums.simulated_squares > 0.0)) {
    return pixels;
  }
  const double gain = sums.products / sums.simulated_squares;
  const double rest = std::max(sums.real_squares - gain * sums.products, 0.0);
  const double noise = options.noise_over_rest * std::sqrt(rest / sums.pixels);
  const double limit = options.full_scale - std::clamp(kClearOfNoise * noise, kMinClear, kMaxClear);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (shown.values()[i] != 0 && mean_near(real, i) < limit &&
        gain * mean_near(simulated, i) < limit) {
      pixels.push_back(i);
    }
  }
  return pixels;
}

}  // namespace glint
