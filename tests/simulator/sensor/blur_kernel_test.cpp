// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/sensor/blur_kernel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "simulator/sensor/sensor.h"

namespace glint {
namespace {

/// The Gaussian at whole pixels, cut at four sigma, as the sensor has it from 1 px on.
std::vector<float> sampled_gaussian(double sigma_px) {
  std::vector<double> weights;
  double total = 0.0;
  for (int k = 0; k <= static_cast<int>(std::ceil(4.0 * sigma_px)); ++k) {
    weights.push_back(std::exp(-0.5 * (k / sigma_px) * (k / sigma_px)));
    total += (k == 0 ? 1.0 : 2.0) * weights.back();
  }
  std::vector<float> rounded;
  for (const double weight : weights) {
    rounded.push_back(static_cast<float>(weight / total));
  }
  return rounded;
}

template <class Weights>
double variance_of(const Weights& weights) {
  double variance = 0.0;
  for (std::size_t k = 1; k < weights.size(); ++k) {
    variance += 2.0 * static_cast<double>(k * k) * static_cast<double>(weights[k]);
  }
  return variance;
}

template <class Weights>
double contrast_of(const Weights& weights, double per_px) {
  double contrast = static_cast<double>(weights[0]);
  for (std::size_t k = 1; k < weights.size(); ++k) {
    contrast += 2.0 * static_cast<double>(weights[k]) *
                std::cos(2.0 * kPi * per_px * static_cast<double>(k));
  }
  return contrast;
}

/// The largest relative error of variance and contrast against the Gaussian's.
template <class Weights>
double worst_error(const Weights& weights, double sigma_px) {
  double worst = std::abs(variance_of(weights) / (sigma_px * sigma_px) - 1.0);
  for (const double per_px : {0.1, 0.3, 0.45}) {
    const double expected = std::exp(-2.0 * std::pow(kPi * sigma_px * per_px, 2));
    worst = std::max(worst, std::abs(contrast_of(weights, per_px) / expected - 1.0));
  }
  return worst;
}

std::vector<float> weights_of(double sigma_px) {
  return Sensor({.blur_px = sigma_px}, 9, 9).blur_weights();
}

TEST(BlurKernel, NarrowOnesHaveTheGaussiansVarianceAndContrast) {
  Rng rng(61, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const double sigma_px = rng.uniform(0.3, 0.7);
    EXPECT_LT(worst_error(weights_of(sigma_px), sigma_px), 0.02) << sigma_px;
    EXPECT_GT(worst_error(sampled_gaussian(sigma_px), sigma_px), 0.3) << sigma_px;
  }
}

// sigma 0.5: variance 0.25, losses of contrast 1 - exp(-0.444132) = 0.358619 at 0.3 and
// 1 - exp(-0.999297) = 0.631862 at 0.45 cycles a pixel. A pair of weights w takes 2 w (1 - cos(2 pi
// f k)); 1 - cos of 108, 216 and 324 degrees, and of 162, 324 and 486.
TEST(BlurKernel, HalfAPixelByHand) {
  const std::vector<double> w = blur_kernel(0.5);
  ASSERT_EQ(w.size(), 4U);
  EXPECT_NEAR(2.0 * w[1] + 8.0 * w[2] + 18.0 * w[3], 0.25, 1e-12);
  EXPECT_NEAR(2.0 * (1.309017 * w[1] + 1.809017 * w[2] + 0.190983 * w[3]), 0.358619, 1e-6);
  EXPECT_NEAR(2.0 * (1.951057 * w[1] + 0.190983 * w[2] + 1.587785 * w[3]), 0.631862, 1e-6);
  EXPECT_LT(w[2], 0.0);
}

TEST(BlurKernel, FromOnePixelOnIsTheGaussianAtWholePixelsBitForBit) {
  Rng rng(62, Stream::kTest, 0);
  EXPECT_EQ(weights_of(1.0), sampled_gaussian(1.0));
  EXPECT_NE(weights_of(0.99), sampled_gaussian(0.99));
  for (int i = 0; i < 300; ++i) {
    const double sigma_px = rng.uniform(1.0, 9.0);
    EXPECT_EQ(weights_of(sigma_px), sampled_gaussian(sigma_px)) << sigma_px;
  }
}

TEST(BlurKernel, GrowsFromTheIdentityWithoutAStep) {
  EXPECT_EQ(blur_kernel(0.0), std::vector<double>{1.0});
  std::vector<double> last = {1.0};
  double sigma_px = 1e-4;
  while (sigma_px < 1.2) {
    std::vector<double> now = blur_kernel(sigma_px);
    EXPECT_NEAR(2.0 * std::accumulate(now.begin() + 1, now.end(), 0.0) + now[0], 1.0, 1e-12);
    EXPECT_GE(now.size(), last.size());
    last.resize(now.size(), 0.0);
    for (std::size_t k = 0; k < now.size(); ++k) {
      EXPECT_NEAR(now[k], last[k], 3e-4) << sigma_px << ", " << k;
    }
    last = std::move(now);
    sigma_px += 1e-4;
  }
}

TEST(BlurKernel, SlopesAreThoseOfTheWeights) {
  Rng rng(63, Stream::kTest, 0);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 1000; ++i) {
    const double sigma_px = rng.uniform(0.01, 2.0);
    const std::vector<double> slope = blur_kernel_derivative(sigma_px);
    const std::vector<double> high = blur_kernel(sigma_px + kStep);
    const std::vector<double> low = blur_kernel(sigma_px - kStep);
    ASSERT_EQ(slope.size(), blur_kernel(sigma_px).size());
    if (high.size() != low.size()) {
      continue;  // where the reach grows
    }
    for (std::size_t k = 0; k < slope.size(); ++k) {
      EXPECT_NEAR(slope[k], (high[k] - low[k]) / (2.0 * kStep), 1e-7) << sigma_px << ", " << k;
    }
  }
}

ImageF blurred(const ImageF& radiance, double sigma_px) {
  ImageF frame;
  Sensor({.gain = 0.5, .blur_px = sigma_px, .bits = 0}, radiance.width(), radiance.height())
      .expose(radiance, 0, frame);
  for (float& value : frame.values()) {
    value *= 2.0F;
  }
  return frame;
}

// No weights >= 0 could: sin^2(k x) <= k^2 sin^2(x), so they take at most 2 variance sin^2(pi f) of
// the contrast at f, and the Gaussian takes more.
TEST(BlurKernel, OfAHalfPixelMustOvershoot) {
  for (const double sigma_px : {0.3, 0.4, 0.5, 0.6, 0.63}) {
    const double most = 2.0 * std::pow(sigma_px * std::sin(kPi * 0.45), 2);
    EXPECT_GT(1.0 - 1.02 * std::exp(-2.0 * std::pow(kPi * sigma_px * 0.45, 2)), 1.02 * most);
    EXPECT_GT(blur_overshoot(sigma_px), 0.0);
  }
  EXPECT_EQ(blur_overshoot(0.7), 0.0);
  EXPECT_EQ(blur_overshoot(0.85), 0.0);
  EXPECT_EQ(blur_overshoot(0.0), 0.0);
}

// Black and white: nothing below black; the white side exceeds 1 by 0.015 at most.
TEST(BlurKernel, AnEdgeHasNoNegativeLight) {
  double most = 0.0;
  double sigma_px = 0.05;
  while (sigma_px < 1.1) {
    ImageF edge(16, 5);
    for (int y = 0; y < 5; ++y) {
      std::fill_n(edge.row(y) + 8, 8, 1.0F);
    }
    const ImageF found = blurred(edge, sigma_px);
    const auto [low, high] = std::ranges::minmax(found.values());
    EXPECT_GE(low, 0.0F) << sigma_px;
    most = std::max(most, static_cast<double>(high) - 1.0);
    EXPECT_LE(high, 1.0 + blur_overshoot(sigma_px) + 1e-6) << sigma_px;
    if (sigma_px > 0.69) {
      EXPECT_LE(high, 1.0F + 1e-6F) << sigma_px;
    }
    sigma_px += 0.05;
  }
  EXPECT_LT(most, 0.0152);
  EXPECT_GT(most, 0.01);
}

// Cut off at 0 it holds some more light than there was: 8 % at most.
TEST(BlurKernel, ASingleBrightPixelHasNoNegativeLight) {
  double sigma_px = 0.05;
  while (sigma_px < 1.1) {
    ImageF point(15, 15);
    point(7, 7) = 1.0F;
    const ImageF found = blurred(point, sigma_px);
    EXPECT_GE(*std::ranges::min_element(found.values()), 0.0F);
    const double total = std::accumulate(found.values().begin(), found.values().end(), 0.0);
    EXPECT_NEAR(total, 1.0 + 0.5 * blur_overshoot(sigma_px), 0.5 * blur_overshoot(sigma_px) + 1e-6)
        << sigma_px;
    EXPECT_LT(total, 1.08);
    sigma_px += 0.05;
  }
}

// A frame with noise and a dark signal: nothing is taken from the dark signal beside an edge.
TEST(BlurKernel, AnEdgeTakesNothingFromTheDarkSignal) {
  ImageF edge(64, 64);
  for (int y = 0; y < 64; ++y) {
    std::fill_n(edge.row(y) + 32, 32, 1.0F);
  }
  const Sensor sensor(
      {.gain = 0.5, .blur_px = 0.45, .bits = 0, .full_well_e = 20000.0, .dark_e = 100.0}, 64, 64);
  double beside = 0.0;
  for (int index = 0; index < 40; ++index) {
    ImageF frame;
    sensor.expose(edge, index, frame);
    for (int y = 0; y < 64; ++y) {
      beside += static_cast<double>(frame(30, y)) / (40.0 * 64.0);
    }
  }
  // 100 electrons with a deviation of 10 in 2560 pixels: 0.2 of them.
  EXPECT_NEAR(beside * 20000.0 / 0.5, 100.0, 1.0);
}

}  // namespace
}  // namespace glint
