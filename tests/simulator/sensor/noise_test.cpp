// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <thread>
#include <vector>

#include "simulator/sensor/sensor.h"

namespace glint {
namespace {

constexpr int kSide = 500;
constexpr double kPixels = kSide * kSide;
constexpr double kLargestZ = 4.5;  // passed by chance with probability 1 - 7e-6

ImageF flat_frame(const SensorSettings& settings, double radiance, int frame_index = 0) {
  ImageF frame;
  Sensor(settings, kSide, kSide)
      .expose(ImageF(kSide, kSide, static_cast<float>(radiance)), frame_index, frame);
  return frame;
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

Moments moments_of(const ImageF& image) {
  Moments result;
  for (const float value : image.values()) {
    result.mean += static_cast<double>(value) / kPixels;
  }
  for (const float value : image.values()) {
    const double deviation = static_cast<double>(value) - result.mean;
    result.variance += deviation * deviation / (kPixels - 1.0);
  }
  return result;
}

double mean_z(const Moments& seen, const Moments& expected) {
  return std::abs(seen.mean - expected.mean) / std::sqrt(expected.variance / kPixels);
}

double variance_z(const Moments& seen, const Moments& expected) {
  return std::abs(seen.variance / expected.variance - 1.0) / std::sqrt(2.0 / kPixels);
}

// K = gain / full well = 2 / 10000 = 2e-4 per electron. At L = 0.25: 2500 + 20 dark electrons, so
// mean 0.504; variance K^2 (2520 + 5^2) = 4e-8 x 2545 = 1.018e-4.
TEST(SensorNoise, HasTheMeanAndVarianceOfEmva1288) {
  const SensorSettings settings{
      .gain = 2.0, .bits = 0, .full_well_e = 10000.0, .read_noise_e = 5.0, .dark_e = 20.0};
  const Moments seen = moments_of(flat_frame(settings, 0.25));
  const Moments expected{0.504, 1.018e-4};
  EXPECT_LT(mean_z(seen, expected), kLargestZ);
  EXPECT_LT(variance_z(seen, expected), kLargestZ);
  EXPECT_GT(mean_z(seen, {0.504 * 1.001, 1.018e-4}), 2 * kLargestZ) << "cannot see 0.1 %";
  EXPECT_GT(variance_z(seen, {0.504, 1.018e-4 * 1.04}), 2 * kLargestZ) << "cannot see 4 %";
}

// The photon transfer curve of EMVA 1288: variance over mean rises with slope K.
TEST(SensorNoise, GivesTheSystemGainBackFromItsPhotonTransferCurve) {
  const SensorSettings settings{
      .gain = 1.3, .bits = 12, .full_well_e = 8000.0, .read_noise_e = 6.0};
  const Moments low = moments_of(flat_frame(settings, 0.05, 1));
  const Moments high = moments_of(flat_frame(settings, 0.55, 2));
  const double slope = (high.variance - low.variance) / (high.mean - low.mean);
  EXPECT_NEAR(slope / (1.3 / 8000.0), 1.0, 0.015);  // 4.5 x sqrt(2 / 250000) = 0.013
}

double poisson_chi_square(const std::array<double, 14>& counts, double mean) {
  double probability = std::exp(-mean);
  double rest = kPixels;
  double chi_square = 0.0;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const double expected = k + 1 < counts.size() ? kPixels * probability : rest;
    chi_square += (counts[k] - expected) * (counts[k] - expected) / expected;
    rest -= expected;
    probability *= mean / static_cast<double>(k + 1);
  }
  return chi_square;
}

// 14 classes (0 ... 12 electrons and more), 13 degrees of freedom: chi-square above 45 has
// probability 2e-5.
TEST(SensorNoise, IsExactlyPoissonForFewElectrons) {
  const SensorSettings settings{.bits = 0, .full_well_e = 1000.0};
  const ImageF frame = flat_frame(settings, 0.004);
  std::array<double, 14> counts = {};
  for (const float value : frame.values()) {
    const double electrons = static_cast<double>(value) * 1000.0;
    EXPECT_NEAR(electrons, std::round(electrons), 1e-3);
    counts[static_cast<std::size_t>(std::min(13.0, std::round(electrons)))] += 1.0;
  }
  EXPECT_LT(poisson_chi_square(counts, 4.0), 45.0);
  EXPECT_GT(poisson_chi_square(counts, 4.05), 90.0) << "cannot tell a mean of 4 from 4.05";
}

TEST(SensorNoise, KeepsMeanAndVarianceWhereTheGaussianTakesOver) {
  const SensorSettings settings{.bits = 0, .full_well_e = 1000.0};
  for (const double electrons : {29.5, 30.5}) {
    SCOPED_TRACE(electrons);
    const Moments seen = moments_of(flat_frame(settings, electrons / 1000.0));
    const Moments expected{electrons * 1e-3, electrons * 1e-6};
    EXPECT_LT(mean_z(seen, expected), kLargestZ);
    EXPECT_LT(variance_z(seen, expected), kLargestZ);
  }
}

// 7000 electrons where full scale is 10000 / 2 = 5000: 20 standard deviations above.
TEST(SensorNoise, VanishesInClippingAndInTheDark) {
  const SensorSettings settings{.gain = 2.0, .full_well_e = 10000.0, .read_noise_e = 10.0};
  EXPECT_EQ(flat_frame(settings, 0.7), ImageF(kSide, kSide, 1.0f));
  EXPECT_EQ(flat_frame({.full_well_e = 10000.0}, 0.0), ImageF(kSide, kSide, 0.0f));
  EXPECT_GT(moments_of(flat_frame(settings, 0.4)).variance, 1e-5);
}

double correlation(const ImageF& a, const ImageF& b, std::size_t shift) {
  const Moments of_a = moments_of(a);
  const Moments of_b = moments_of(b);
  double sum = 0.0;
  for (std::size_t i = 0; i + shift < a.size(); ++i) {
    sum += (static_cast<double>(a.values()[i]) - of_a.mean) *
           (static_cast<double>(b.values()[i + shift]) - of_b.mean);
  }
  return sum / kPixels / std::sqrt(of_a.variance * of_b.variance);
}

TEST(SensorNoise, IsIndependentBetweenFramesSeedsAndPixels) {
  SensorSettings settings{.bits = 0, .full_well_e = 10000.0, .read_noise_e = 100.0};
  const ImageF first = flat_frame(settings, 0.4, 0);
  const ImageF next = flat_frame(settings, 0.4, 1);
  settings.seed = 2;
  const ImageF reseeded = flat_frame(settings, 0.4, 0);
  const double bound = kLargestZ / std::sqrt(kPixels);
  EXPECT_LT(std::abs(correlation(first, next, 0)), bound);
  EXPECT_LT(std::abs(correlation(first, reseeded, 0)), bound);
  for (const std::size_t shift : {1U, 2U, 3U, 4U, 500U}) {
    EXPECT_LT(std::abs(correlation(first, first, shift)), bound) << shift;
  }
  EXPECT_NEAR(correlation(first, first, 0), 1.0, 1e-4);
}

TEST(SensorNoise, IsTheSameInAnyOrderAndOnAnyThread) {
  const SensorSettings settings{.full_well_e = 3000.0, .read_noise_e = 7.0, .dark_e = 2.0};
  const Sensor sensor(settings, 77, 31);
  ImageF radiance(77, 31);
  for (int y = 0; y < 31; ++y) {
    for (int x = 0; x < 77; ++x) {
      radiance(x, y) = 0.0003f * static_cast<float>(x);  // 2 to 70 electrons: exact and Gaussian
    }
  }
  constexpr int kFrames = 7;
  std::vector<ImageF> backwards(kFrames);
  for (int frame = kFrames - 1; frame >= 0; --frame) {
    sensor.expose(radiance, frame, backwards[static_cast<std::size_t>(frame)]);
  }
  std::vector<ImageF> at_once(kFrames);
  {
    std::vector<std::jthread> threads;
    for (int frame = 0; frame < kFrames; ++frame) {
      threads.emplace_back([&sensor, &radiance, &at_once, frame] {
        sensor.expose(radiance, frame, at_once[static_cast<std::size_t>(frame)]);
      });
    }
  }
  EXPECT_EQ(backwards, at_once);
  EXPECT_NE(backwards[0], backwards[1]);
}

// A row's width need not be a multiple of the four pixels that share a random block.
TEST(SensorNoise, DependsOnThePixelAndNotOnTheRowBlocks) {
  const SensorSettings settings{
      .blur_px = 0.0, .bits = 0, .full_well_e = 10000.0, .read_noise_e = 3.0};
  ImageF as_rows;
  Sensor(settings, 7, 9).expose(ImageF(7, 9, 0.5f), 4, as_rows);
  ImageF as_line;
  Sensor(settings, 63, 1).expose(ImageF(63, 1, 0.5f), 4, as_line);
  EXPECT_EQ(as_rows.values(), as_line.values());
}

}  // namespace
}  // namespace glint
