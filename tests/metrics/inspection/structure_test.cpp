// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/inspection/structure.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "metrics/inspection/inspector.h"

namespace glint {
namespace {

constexpr int kPictureSide = 120;
constexpr double kPeriod_px = 12.0;

/// exp() of two crossed waves, less what the logarithm adds.
ImageF crossed_waves(double along_x, double along_y) {
  ImageF picture(kPictureSide, kPictureSide);
  const double turn = 2.0 * kPi / kPeriod_px;
  for (int y = 0; y < kPictureSide; ++y) {
    for (int x = 0; x < kPictureSide; ++x) {
      const double value = along_x * std::sin(turn * x) + along_y * std::sin(turn * y);
      picture(x, y) = static_cast<float>(0.5 * std::exp(value) - 0.03);
    }
  }
  return picture;
}

ImageF noisy_picture(std::uint64_t index, double deviation) {
  ImageF picture(kPictureSide, kPictureSide);
  Rng rng(11, Stream::kTest, index);
  for (float& grey : picture.values()) {
    grey = static_cast<float>(0.5 + deviation * rng.normal());
  }
  return picture;
}

/// What a Gaussian of sigma 1 with 3 taps to either side leaves of a wave: (1 + 2 sum e^(-k^2/2)
/// cos(k t)) / (1 + 2 sum e^(-k^2/2)).
double left_by_smoothing() {
  double sum = 1.0;
  double wave = 1.0;
  for (int k = 1; k <= 3; ++k) {
    sum += 2.0 * std::exp(-0.5 * k * k);
    wave += 2.0 * std::exp(-0.5 * k * k) * std::cos(k * 2.0 * kPi / kPeriod_px);
  }
  return wave / sum;
}

// The derivative of B sin(t y) by central differences is B sin(t) cos(t y), t = 30 degrees: its
// mean square over the window is (B / 2)^2 / 2, the products of both waves cancel. The wave along x
// is the larger one and does not count.
TEST(StructureOf, IsTheSmallerOfTwoCrossedWaves) {
  ThreadPool pool(2);
  const ImageF structure =
      structure_of(crossed_waves(0.4, 0.1), Mask(kPictureSide, kPictureSide, 1), 36.0, pool);
  const double expected = 0.1 * 0.5 / std::sqrt(2.0) * left_by_smoothing();
  for (int y = 45; y < 75; ++y) {
    for (int x = 45; x < 75; ++x) {
      ASSERT_NEAR(std::abs(structure(x, y)), expected, 0.01 * expected) << x << ", " << y;
    }
  }
}

// Across the grooves the root of the mean square is about 0.2.
TEST(StructureOf, IsNothingForGroovesInAnyDirection) {
  ThreadPool pool(2);
  for (int degrees = 0; degrees < 180; degrees += 15) {
    const double across_x = std::cos(degrees * kRadPerDeg);
    const double across_y = std::sin(degrees * kRadPerDeg);
    ImageF picture(kPictureSide, kPictureSide);
    for (int y = 0; y < kPictureSide; ++y) {
      for (int x = 0; x < kPictureSide; ++x) {
        const double at = across_x * x + across_y * y;
        picture(x, y) = static_cast<float>(0.5 + 0.3 * std::sin(0.5 * at));
      }
    }
    const ImageF structure = structure_of(picture, Mask(kPictureSide, kPictureSide, 1), 16.0, pool);
    for (int i = 20; i < kPictureSide - 20; ++i) {
      ASSERT_LT(std::abs(structure(i, i)), 2e-3F) << degrees;
      ASSERT_LT(std::abs(structure(i, kPictureSide - i)), 2e-3F) << degrees;
    }
  }
}

TEST(StructureOf, SeesNothingOutsideTheMask) {
  ThreadPool pool(2);
  Mask mask(kPictureSide, kPictureSide);
  for (int y = 30; y < 90; ++y) {
    for (int x = 20; x < 70; ++x) {
      mask(x, y) = 1;
    }
  }
  ImageF picture = noisy_picture(1, 0.05);
  const ImageF structure = structure_of(picture, mask, 12.0, pool);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    picture.values()[i] = mask.values()[i] != 0 ? picture.values()[i] : 0.9F;
  }
  EXPECT_EQ(structure_of(picture, mask, 12.0, pool).values(), structure.values());
  EXPECT_EQ(structure(10, 10), 0.0F);
  EXPECT_NE(structure(20, 30), 0.0F) << "the mask's own corner";
}

TEST(StructureOf, HardlyChangesWithTheLight) {
  ThreadPool pool(2);
  const ImageF picture = noisy_picture(2, 0.02);
  ImageF darker = picture;
  for (float& grey : darker.values()) {
    grey *= 0.6F;
  }
  const Mask whole(kPictureSide, kPictureSide, 1);
  const ImageF bright = structure_of(picture, whole, 16.0, pool);
  const ImageF dark = structure_of(darker, whole, 16.0, pool);
  for (std::size_t i = 0; i < bright.size(); ++i) {
    const float size = std::abs(bright.values()[i]);
    ASSERT_NEAR(std::abs(dark.values()[i]), size, 0.05F * size);
  }
}

TEST(StructureOf, IsNegativeWhereItIsDarkerThanAround) {
  ThreadPool pool(2);
  ImageF picture(kPictureSide, kPictureSide, 0.5F);
  picture(30, 60) = picture(31, 61) = 0.2F;
  picture(90, 60) = picture(91, 61) = 0.8F;
  const ImageF structure = structure_of(picture, Mask(kPictureSide, kPictureSide, 1), 8.0, pool);
  EXPECT_LT(structure(30, 60), -0.01F);
  EXPECT_GT(structure(90, 60), 0.01F);
}

// Twenty specks of different strength on noise; a cap of five leaves the five strongest.
TEST(Inspector, ReportsNoMoreThanAskedFor) {
  ThreadPool pool(2);
  ImageF picture(400, 100, 0.5F);
  Rng rng(12, Stream::kTest, 0);
  for (float& grey : picture.values()) {
    grey += static_cast<float>(0.002 * rng.normal());
  }
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 9; ++k) {
      picture(10 + 20 * i + k % 3, 50 + k / 3) -= 0.05F + 0.015F * static_cast<float>(i);
    }
  }
  InspectionSettings settings = photograph_settings();
  settings.max_reports = 0;
  const Mask whole(400, 100, 1);
  const std::size_t all = Inspector(settings, whole).inspect(picture, pool).defects.size();
  EXPECT_GE(all, 20U);
  settings.max_reports = 5;
  const Inspection five = Inspector(settings, whole).inspect(picture, pool);
  ASSERT_EQ(five.defects.size(), 5U);
  for (const FoundDefect& report : five.defects) {
    EXPECT_GT(report.x_px, 300.0);
  }
  settings.max_reports = static_cast<int>(all);
  EXPECT_EQ(Inspector(settings, whole).inspect(picture, pool).defects.size(), all);
}

}  // namespace
}  // namespace glint
