// SPDX-License-Identifier: GPL-3.0-or-later
//
// The narrow blur's weights solve three linear equations: sum of 2 w_k k^2 = sigma^2, and
// sum of 2 w_k (1 - cos(2 pi f k)) = 1 - exp(-2 (pi sigma f)^2) at two frequencies f. The wide
// blur's are the Gaussian's, cut at four sigma. docs/theory/sensor.md, "Narrow blur". Cost: some
// exponentials. Memory: a few weights.
#include "simulator/sensor/blur_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

#include "core/units.h"

namespace glint {
namespace {

constexpr double kTruncationSigmas = 4.0;

/// Up to the first the weights are those of the equations, from the second on the Gaussian's.
constexpr double kWidestFitted_px = 0.7;
constexpr double kNarrowestSampled_px = 1.0;

constexpr int kFittedReach_px = 3;
constexpr std::array<double, 2> kFrequencies_per_px = {0.3, 0.45};

double contrast_of(double sigma_px, double per_px) {
  const double turn = kPi * sigma_px * per_px;
  return std::exp(-2.0 * turn * turn);
}

/// Puts the centre before one side.
std::vector<double> around_centre(double total, const Eigen::Vector3d& side) {
  return {total - 2.0 * side.sum(), side[0], side[1], side[2]};
}

/// The weights of one side that have this variance and these losses of contrast.
Eigen::Vector3d fitted_side(const Eigen::Vector3d& variance_and_losses) {
  Eigen::Matrix3d of_weights;
  for (int k = 1; k <= kFittedReach_px; ++k) {
    of_weights(0, k - 1) = 2.0 * k * k;
    for (int i = 0; i < 2; ++i) {
      const double f = kFrequencies_per_px[static_cast<std::size_t>(i)];
      of_weights(i + 1, k - 1) = 2.0 * (1.0 - std::cos(2.0 * kPi * f * k));
    }
  }
  return of_weights.partialPivLu().solve(variance_and_losses);
}

std::vector<double> fitted_kernel(double sigma_px) {
  Eigen::Vector3d wanted(sigma_px * sigma_px, 0.0, 0.0);
  for (int i = 0; i < 2; ++i) {
    wanted[i + 1] = 1.0 - contrast_of(sigma_px, kFrequencies_per_px[static_cast<std::size_t>(i)]);
  }
  return around_centre(1.0, fitted_side(wanted));
}

std::vector<double> fitted_slope(double sigma_px) {
  Eigen::Vector3d wanted(2.0 * sigma_px, 0.0, 0.0);
  for (int i = 0; i < 2; ++i) {
    const double f = kFrequencies_per_px[static_cast<std::size_t>(i)];
    wanted[i + 1] = 4.0 * kPi * kPi * f * f * sigma_px * contrast_of(sigma_px, f);
  }
  return around_centre(0.0, fitted_side(wanted));
}

std::vector<double> sampled_kernel(double sigma_px) {
  const auto reach = static_cast<std::size_t>(std::ceil(kTruncationSigmas * sigma_px));
  std::vector<double> weights(reach + 1, 1.0);
  double total = 1.0;
  for (std::size_t k = 1; k < weights.size(); ++k) {
    const double distance = static_cast<double>(k) / sigma_px;
    weights[k] = std::exp(-0.5 * distance * distance);
    total += 2.0 * weights[k];
  }
  for (double& weight : weights) {
    weight /= total;
  }
  return weights;
}

/// A weight w at the distance k changes by w (k^2 - variance) / sigma^3.
std::vector<double> sampled_slope(double sigma_px) {
  std::vector<double> weights = sampled_kernel(sigma_px);
  double variance = 0.0;
  for (std::size_t k = 1; k < weights.size(); ++k) {
    variance += 2.0 * static_cast<double>(k * k) * weights[k];
  }
  for (std::size_t k = 0; k < weights.size(); ++k) {
    weights[k] *= (static_cast<double>(k * k) - variance) / (sigma_px * sigma_px * sigma_px);
  }
  return weights;
}

/// Share of the Gaussian at whole pixels, and its derivative by sigma: a cubic without kinks.
struct Share {
  double value = 0.0;
  double slope = 0.0;
};

Share sampled_share(double sigma_px) {
  const double width = kNarrowestSampled_px - kWidestFitted_px;
  const double t = (sigma_px - kWidestFitted_px) / width;
  return {.value = t * t * (3.0 - 2.0 * t), .slope = 6.0 * t * (1.0 - t) / width};
}

/// a[k] += factor b[k]; the longer of both is as long as the result.
void add(double factor, const std::vector<double>& b, std::vector<double>& a) {
  a.resize(std::max(a.size(), b.size()), 0.0);
  for (std::size_t k = 0; k < b.size(); ++k) {
    a[k] += factor * b[k];
  }
}

}  // namespace

std::vector<double> blur_kernel(double sigma_px) {
  if (sigma_px <= 0.0) {
    return {1.0};
  }
  if (sigma_px >= kNarrowestSampled_px) {
    return sampled_kernel(sigma_px);
  }
  if (sigma_px <= kWidestFitted_px) {
    return fitted_kernel(sigma_px);
  }
  const Share sampled = sampled_share(sigma_px);
  std::vector<double> mixed;
  add(1.0 - sampled.value, fitted_kernel(sigma_px), mixed);
  add(sampled.value, sampled_kernel(sigma_px), mixed);
  return mixed;
}

std::vector<double> blur_kernel_derivative(double sigma_px) {
  if (sigma_px <= 0.0) {
    return {0.0};
  }
  if (sigma_px >= kNarrowestSampled_px) {
    return sampled_slope(sigma_px);
  }
  if (sigma_px <= kWidestFitted_px) {
    return fitted_slope(sigma_px);
  }
  const Share sampled = sampled_share(sigma_px);
  std::vector<double> mixed;
  add(1.0 - sampled.value, fitted_slope(sigma_px), mixed);
  add(sampled.value, sampled_slope(sigma_px), mixed);
  add(-sampled.slope, fitted_kernel(sigma_px), mixed);
  add(sampled.slope, sampled_kernel(sigma_px), mixed);
  return mixed;
}

double blur_overshoot(double sigma_px) {
  const std::vector<double> kernel = blur_kernel(sigma_px);
  double negative = 0.0;
  for (std::size_t k = 0; k < kernel.size(); ++k) {
    negative += (k == 0 ? 1.0 : 2.0) * std::max(0.0, -kernel[k]);
  }
  return 2.0 * negative * (1.0 + negative);
}

}  // namespace glint
