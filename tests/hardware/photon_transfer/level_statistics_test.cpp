// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/photon_transfer/level_statistics.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

TEST(LevelStatistics, FollowsTheArithmeticOfTwoSmallPictures) {
  ImageF a(2, 1);
  ImageF b(2, 1);
  a.values() = {10.0F, 14.0F};
  b.values() = {13.0F, 15.0F};
  // Means 12 and 14; without them -2 2 and -1 1. Of each pixel's two values the variance is
  // (1^2) / 2 = 0.5. The mean picture is 11.5 14.5, its variance 4.5; half of 0.5 is noise.
  const LevelStatistics level = level_statistics(std::array{a, b}, 15.0);
  EXPECT_EQ(level.pictures, 2);
  EXPECT_DOUBLE_EQ(level.mean_dn, 13.0);
  EXPECT_DOUBLE_EQ(level.temporal_variance_dn2, 0.5);
  EXPECT_DOUBLE_EQ(level.spatial_variance_dn2, 4.25);
  EXPECT_DOUBLE_EQ(level.clipped_share, 0.25);
  EXPECT_DOUBLE_EQ(level.zero_share, 0.0);
}

// All codes alike: the error is that of rounding alone, 1/12 sqrt(2 / 2 pixels).
TEST(LevelStatistics, KnowsNoVarianceBetterThanRoundingAllows) {
  const ImageF dark(2, 1);
  const LevelStatistics level = level_statistics(std::array{dark, dark}, 15.0);
  EXPECT_DOUBLE_EQ(level.temporal_variance_dn2, 0.0);
  EXPECT_DOUBLE_EQ(level.variance_error_dn2, 1.0 / 12.0);
  EXPECT_DOUBLE_EQ(level.zero_share, 1.0);
}

TEST(LevelStatistics, ALampThatFlickersIsNoNoise) {
  ImageF a(40, 30);
  for (std::size_t i = 0; i < a.size(); ++i) {
    a.values()[i] = static_cast<float>(i % 7);
  }
  ImageF b = a;
  for (float& value : b.values()) {
    value += 5.0F;
  }
  const LevelStatistics level = level_statistics(std::array{a, b}, 255.0);
  EXPECT_NEAR(level.temporal_variance_dn2, 0.0, 1e-9);
  EXPECT_GT(level.spatial_variance_dn2, 3.0);
}

/// @param count  of pictures
LevelStatistics level_of_noise(std::size_t count, double sigma, double pattern) {
  std::vector<ImageF> pictures(count, ImageF(200, 150));
  for (std::size_t i = 0; i < pictures[0].size(); ++i) {
    Rng rng(3, Stream::kTest, i);
    const double pixel = 100.0 + pattern * rng.normal();
    for (ImageF& picture : pictures) {
      picture.values()[i] = static_cast<float>(pixel + sigma * rng.normal());
    }
  }
  return level_statistics(pictures, 255.0);
}

TEST(LevelStatistics, SeparatesNoiseFromThePixelsOwnPattern) {
  for (const std::size_t count : {2U, 5U}) {
    const LevelStatistics level = level_of_noise(count, 3.0, 2.0);
    EXPECT_NEAR(level.temporal_variance_dn2, 9.0, 4.0 * level.variance_error_dn2);
    EXPECT_NEAR(level.spatial_variance_dn2, 4.0, 0.2);
  }
  // What it says of its own error is right: 9 sqrt(2 / 30000) = 0.0735.
  EXPECT_NEAR(level_of_noise(2, 3.0, 0.0).variance_error_dn2, 0.0735, 0.002);
}

}  // namespace
}  // namespace glint
