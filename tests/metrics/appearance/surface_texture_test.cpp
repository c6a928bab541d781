// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/appearance/surface_texture.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

template <class Grey>
ImageF picture_of(int size, const Grey& grey) {
  ImageF picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      picture(x, y) = static_cast<float>(grey(x, y));
    }
  }
  return picture;
}

ImageF white_noise(int size, double mean, double deviation, std::uint64_t index) {
  Rng rng(4, Stream::kTest, index);
  return picture_of(size, [&](int, int) { return mean + deviation * rng.normal(); });
}

/// Parallel lines of a period, in a direction.
ImageF lines(int size, double period_px, double lay_rad) {
  return picture_of(size, [&](int x, int y) {
    const double across = -x * std::sin(lay_rad) + y * std::cos(lay_rad);
    return 0.5 + 0.1 * std::cos(2.0 * kPi * across / period_px);
  });
}

// The density of white noise is its relative variance, (0.05 / 0.5)^2 = 0.01, at all frequencies.
TEST(TextureOf, WhiteNoiseHasItsVarianceAtEveryFrequency) {
  const SurfaceTexture texture =
      texture_of(white_noise(512, 0.5, 0.05, 0), {}, {.window_px = 128, .max_windows = 64});
  EXPECT_EQ(texture.windows, 49);
  EXPECT_EQ(texture_of(white_noise(512, 0.5, 0.05, 0), {}, {.window_px = 128}).windows, 32);
  for (std::size_t i = 2; i < texture.radial.size(); ++i) {
    EXPECT_NEAR(texture.radial[i], 0.01, 0.0015) << i;
  }
  for (const double share : texture.angular) {
    EXPECT_NEAR(share, 1.0 / 36.0, 0.004);
  }
  EXPECT_NEAR(texture.spread, 0.1, 0.002);
  EXPECT_LT(texture.lay_strength, 0.05);
  EXPECT_LT(texture.autocorrelation_px, 1.0);
}

// cos(2 pi r / 12) = 0.2 at r = 12 acos(0.2) / (2 pi) = 2.615.
TEST(TextureOf, FindsTheLayOfParallelLines) {
  for (const double lay_deg : {0.0, 30.0, 75.0, 120.0, 165.0}) {
    const double lay = lay_deg * kPi / 180.0;
    const SurfaceTexture texture = texture_of(lines(256, 12.0, lay));
    const double apart = std::abs(texture.lay_rad - lay);
    EXPECT_LT(std::min(apart, kPi - apart), 0.02) << lay_deg;
    EXPECT_GT(texture.lay_strength, 0.95);
    EXPECT_NEAR(texture.autocorrelation_px, 12.0 * std::acos(0.2) / (2.0 * kPi), 0.1) << lay_deg;
    EXPECT_GT(texture.longest_px, 60.0);
  }
}

// Columns of 0.4 and 0.6 in turn: one standard deviation below and above the mean, so levels
// floor(32 (3 - 1) / 6) = 10 and floor(32 (3 + 1) / 6) = 21. Of the four lags three go from one
// column to the other: contrast 3/4 of 11^2, correlation (-1 + 1 - 1 - 1) / 4; two cells hold all
// pairs: energy 1/2, entropy 1 bit.
TEST(TextureOf, CooccurrenceOfColumnsIsWhatOneCounts) {
  const SurfaceTexture texture = texture_of(
      picture_of(128, [](int x, int) { return x % 2 == 0 ? 0.4 : 0.6; }), {}, {.window_px = 128});
  EXPECT_NEAR(texture.cooccurrence.contrast, 90.75, 1e-9);
  EXPECT_NEAR(texture.cooccurrence.correlation, -0.5, 1e-3);
  EXPECT_NEAR(texture.cooccurrence.energy, 0.5, 1e-3);
  EXPECT_NEAR(texture.cooccurrence.entropy, 1.0, 1e-3);
}

TEST(TextureOf, TakesWindowsThatLieInTheRegion) {
  const ImageF picture = white_noise(300, 0.5, 0.05, 1);
  Mask region(300, 300);
  EXPECT_EQ(texture_of(picture, region).windows, 0);
  for (int y = 40; y < 120; ++y) {
    for (int x = 30; x < 200; ++x) {
      region(x, y) = 1;
    }
  }
  const SurfaceTexture texture = texture_of(picture, region);
  EXPECT_GT(texture.windows, 0);
  EXPECT_EQ(texture.window_px, 32);  // of 64 px none lies on the grid of half windows in 80 rows
}

TEST(DistanceBetween, IsSmallForTwoSamplesOfOneTextureAndExposureDoesNotCount) {
  const SurfaceTexture a = texture_of(white_noise(512, 0.5, 0.05, 2));
  const SurfaceTexture b = texture_of(white_noise(512, 0.25, 0.025, 3));
  const TextureDistance distance = distance_between(a, b);
  EXPECT_LT(distance.radial, 0.1);
  EXPECT_LT(distance.contrast, 0.02);
  EXPECT_LT(distance.length, 0.05);
}

// Three times the amplitude: nine times the power, log10 9 = 0.954.
TEST(DistanceBetween, IsTheLogarithmOfTheRatioOfSpectra) {
  ImageF weak = white_noise(512, 0.0, 0.05, 4);
  ImageF strong = weak;
  for (std::size_t i = 0; i < weak.size(); ++i) {
    strong.values()[i] = 0.5F + 3.0F * weak.values()[i];
    weak.values()[i] += 0.5F;
  }
  EXPECT_NEAR(distance_between(texture_of(weak), texture_of(strong)).radial, std::log10(9.0), 0.02);
}

TEST(DistanceBetween, MeasuresTheAngleBetweenTwoLays) {
  const TextureDistance distance =
      distance_between(texture_of(lines(256, 12.0, 0.1)), texture_of(lines(256, 12.0, kPi - 0.2)));
  EXPECT_NEAR(distance.lay_rad, 0.3, 0.03);
  EXPECT_GT(distance.angular, 0.8);
}

TEST(DistanceBetween, RefusesTexturesWithoutWindows) {
  EXPECT_THROW(distance_between(SurfaceTexture(), SurfaceTexture()), ConfigError);
}

}  // namespace
}  // namespace glint
