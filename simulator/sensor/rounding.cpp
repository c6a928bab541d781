// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/sensor/rounding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/units.h"

namespace glint {
namespace {

constexpr double kReach = 6.0;      ///< deviations; nothing beyond
constexpr double kMultiple = 0.05;  ///< of a step: 12 bits in a file of 16 are off by 0.03
constexpr std::array<int, 4> kRoundedBits = {8, 10, 12, 14};

double step_of(int bits) {
  return 1.0 / (std::exp2(bits) - 1.0);
}

}  // namespace

RoundedGrey rounded_normal(double mean, double deviation, double step) {
  const double last = std::round(1.0 / step);
  const auto level_of = [&](double value) {
    return std::clamp(std::round(value / step), 0.0, last);
  };
  const auto share_below = [&](double value) {
    return 0.5 * std::erfc((mean - value) / (deviation * std::numbers::sqrt2));
  };
  const double first = level_of(mean - kReach * deviation);
  const double end = level_of(mean + kReach * deviation);
  RoundedGrey sum;
  double below = 0.0;
  double level = first;
  while (level <= end) {
    const double to = level == end ? 1.0 : share_below((level + 0.5) * step);
    const double offset = (level - first) * step;
    sum.mean += (to - below) * offset;
    sum.variance += (to - below) * offset * offset;
    below = to;
    level += 1.0;
  }
  return {.mean = first * step + sum.mean,
          .variance = std::max(0.0, sum.variance - sum.mean * sum.mean)};
}

double grey_noise(const SensorSettings& settings, double grey) {
  if (settings.full_well_e <= 0.0) {
    return 0.0;
  }
  const double per_electron = settings.gain / settings.full_well_e;
  const double electrons = std::max(0.0, grey) / per_electron + settings.dark_e;
  return per_electron * std::sqrt(electrons + settings.read_noise_e * settings.read_noise_e);
}

double rounding_bias(double grey, double deviation, double step) {
  if (deviation >= step && grey >= kReach * deviation && grey <= 1.0 - kReach * deviation) {
    return 0.0;  // below 1e-9 of a step
  }
  if (deviation <= 1e-6 * step) {
    return std::clamp(std::round(grey / step) * step, 0.0, 1.0) - grey;
  }
  return rounded_normal(grey, deviation, step).mean - grey;
}

double largest_rounding_bias(double deviation, double step) {
  const double noise = deviation / step;
  double sum = 0.0;
  for (int k = 1; k <= 100 && sum < 0.5; ++k) {
    sum += std::exp(-2.0 * kPi * kPi * k * k * noise * noise) / (kPi * k);
  }
  return step * std::min(0.5, sum);
}

double recorded_step(const ImageF& picture) {
  const bool is_black =
      std::ranges::all_of(picture.values(), [](float value) { return value <= 0.0F; });
  for (const int bits : kRoundedBits) {
    const double step = step_of(bits);
    const auto is_multiple = [step](float value) {
      const double level = static_cast<double>(value) / step;
      return value <= 0.0F || (level > 0.5 && std::abs(level - std::round(level)) <= kMultiple);
    };
    if (!is_black && std::ranges::all_of(picture.values(), is_multiple)) {
      return step;
    }
  }
  return step_of(16);
}

}  // namespace glint
