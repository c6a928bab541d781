// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/sensor/rounding.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

constexpr double kGreyStep = 1.0 / 255.0;

/// Of steps.
double bias(double grey, double noise) {
  return rounding_bias(grey * kGreyStep, noise * kGreyStep, kGreyStep) / kGreyStep;
}

TEST(Rounding, WithoutNoiseMovesEachGreyValueToItsNearestStep) {
  EXPECT_NEAR(bias(0.3, 0), -0.3, 1e-9) << "recorded as black";
  EXPECT_NEAR(bias(0.7, 0), 0.3, 1e-9);
  EXPECT_NEAR(bias(40.25, 0), -0.25, 1e-9);
  EXPECT_NEAR(largest_rounding_bias(0.0, kGreyStep), 0.5 * kGreyStep, 1e-12);
}

// Of a sawtooth blurred by the noise: sum over k of (-1)^k sin(2 pi k x) exp(-2 pi^2 k^2 n^2) / pi
// k.
TEST(Rounding, WithNoiseIsABlurredSawtooth) {
  for (const double noise : {0.1, 0.25, 0.5}) {
    double largest = 0.0;
    double grey = 10.0;
    while (grey < 11.0) {
      double expected = 0.0;
      for (int k = 1; k < 60; ++k) {
        expected += (k % 2 == 0 ? 1.0 : -1.0) * std::sin(2.0 * kPi * k * grey) *
                    std::exp(-2.0 * kPi * kPi * k * k * noise * noise) / (kPi * k);
      }
      EXPECT_NEAR(bias(grey, noise), expected, 1e-8) << noise << " " << grey;
      largest = std::max(largest, std::abs(expected));
      grey += 0.01;
    }
    EXPECT_LE(largest, largest_rounding_bias(noise * kGreyStep, kGreyStep) / kGreyStep) << noise;
    EXPECT_GE(largest, 0.55 * largest_rounding_bias(noise * kGreyStep, kGreyStep) / kGreyStep)
        << noise;
  }
  EXPECT_LT(largest_rounding_bias(0.25 * kGreyStep, kGreyStep), 0.095 * kGreyStep);
  EXPECT_LT(largest_rounding_bias(0.5 * kGreyStep, kGreyStep), 0.0025 * kGreyStep);
  EXPECT_EQ(bias(10.3, 1.5), 0.0);
}

// Of a number with noise n about 0 half is cut off: n / sqrt(2 pi) is left.
TEST(Rounding, OfADarkSignalIsCutAtBlack) {
  EXPECT_NEAR(bias(0.0, 3.0), 3.0 / std::sqrt(2.0 * kPi), 0.01);
  Rng random(3, Stream::kTest, 0);
  double sum = 0.0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    sum += std::max(0.0, std::round(0.8 + 0.4 * random.normal()));
  }
  EXPECT_NEAR(bias(0.8, 0.4), sum / kDraws - 0.8, 4.0 * 0.5 / std::sqrt(kDraws));
}

TEST(Rounding, OfNoiseIsThatOfElectrons) {
  const SensorSettings sensor = {
      .gain = 2.0, .full_well_e = 10000.0, .read_noise_e = 8.0, .dark_e = 36.0};
  // A quarter of full scale: 1250 electrons of light, each worth 2 / 10000.
  EXPECT_NEAR(grey_noise(sensor, 0.25), 2e-4 * std::sqrt(1250.0 + 36.0 + 64.0), 1e-12);
  EXPECT_EQ(grey_noise({}, 0.25), 0.0);
}

ImageF recorded(int bits, int file_bits) {
  ImageF picture(40, 25);
  const double levels = std::exp2(bits) - 1.0;
  const double file_levels = std::exp2(file_bits) - 1.0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const double code = static_cast<double>(i % 7);
    picture.values()[i] = static_cast<float>(std::round(code / levels * file_levels) / file_levels);
  }
  return picture;
}

TEST(Rounding, ShowsItsStepInThePicture) {
  EXPECT_DOUBLE_EQ(recorded_step(recorded(8, 8)), 1.0 / 255.0);
  EXPECT_DOUBLE_EQ(recorded_step(recorded(8, 16)), 1.0 / 255.0);
  EXPECT_DOUBLE_EQ(recorded_step(recorded(10, 16)), 1.0 / 1023.0);
  EXPECT_DOUBLE_EQ(recorded_step(recorded(12, 16)), 1.0 / 4095.0);
  EXPECT_DOUBLE_EQ(recorded_step(recorded(16, 16)), 1.0 / 65535.0);
  EXPECT_DOUBLE_EQ(recorded_step(ImageF(4, 4)), 1.0 / 65535.0) << "black";
}

}  // namespace
}  // namespace glint
