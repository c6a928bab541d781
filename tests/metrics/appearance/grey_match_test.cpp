// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/appearance/grey_match.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/rng.h"

namespace glint {
namespace {

ImageF row_of(const std::vector<float>& greys) {
  ImageF image(static_cast<int>(greys.size()), 1);
  std::ranges::copy(greys, image.values().begin());
  return image;
}

// 1.5 x + 0.1; the last pixel would be 1.3 and is clipped.
TEST(MatchExposure, FindsGainAndOffsetBesideClippedPixels) {
  const ImageF simulated = row_of({0.1F, 0.2F, 0.4F, 0.8F});
  const ImageF real = row_of({0.25F, 0.4F, 0.7F, 1.0F});
  const ExposureMatch match = match_exposure(simulated, real, {}, ExposureModel::kGainAndOffset);
  EXPECT_EQ(match.pixels, 3U);
  EXPECT_NEAR(match.gain, 1.5, 1e-6);
  EXPECT_NEAR(match.offset, 0.1, 1e-6);
  EXPECT_NEAR(match.rms, 0.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(exposed(simulated, match)(1, 0)), 0.4, 1e-6);
}

// Of gain alone: sum ab / sum aa = (0.1 0.3 + 0.2 0.3) / (0.01 + 0.04) = 1.8; rest 0.12 and -0.06.
TEST(MatchExposure, IsLeastSquaresOfTheGain) {
  const ExposureMatch match = match_exposure(row_of({0.1F, 0.2F}), row_of({0.3F, 0.3F}));
  EXPECT_NEAR(match.gain, 1.8, 1e-6);
  EXPECT_NEAR(match.rms, std::sqrt((0.12 * 0.12 + 0.06 * 0.06) / 2.0), 1e-6);
}

TEST(MatchExposure, OfBlackPicturesChangesNothing) {
  EXPECT_EQ(match_exposure(row_of({0.0F, 0.0F}), row_of({0.5F, 0.5F})).gain, 1.0);
}

TEST(CorrelationOf, IsOneForAnyExposureAndMinusOneForANegative) {
  const ImageF a = row_of({0.1F, 0.5F, 0.2F, 0.9F});
  const ImageF b = row_of({0.25F, 0.45F, 0.3F, 0.65F});  // 0.2 + a / 2
  const ImageF c = row_of({0.9F, 0.5F, 0.8F, 0.1F});     // 1 - a
  EXPECT_NEAR(correlation_of(a, b), 1.0, 1e-6);
  EXPECT_NEAR(correlation_of(a, c), -1.0, 1e-6);
  EXPECT_EQ(correlation_of(a, row_of({0.5F, 0.5F, 0.5F, 0.5F})), 0.0);
}

TEST(ResidualPicture, IsZeroBesideTheRegion) {
  Mask region(3, 1);
  region(1, 0) = 1;
  const ImageF rest =
      residual_picture(row_of({0.1F, 0.2F, 0.3F}), row_of({0.5F, 0.5F, 0.5F}), region);
  EXPECT_EQ(rest(0, 0), 0.0F);
  EXPECT_FLOAT_EQ(rest(1, 0), 0.3F);
  EXPECT_EQ(rest(2, 0), 0.0F);
}

// {0, 1} and {0.5}: either half moves by 0.5. {0, 0, 1} and {0, 1}: a sixth moves by 1.
TEST(HistogramDistance, IsTheWayGreyHasToGo) {
  EXPECT_NEAR(histogram_distance(row_of({0.0F, 1.0F}), row_of({0.5F})), 0.5, 1e-12);
  EXPECT_NEAR(
      histogram_distance(row_of({1.0F, 0.0F, 0.0F}), row_of({0.0F, 1.0F})), 1.0 / 6.0, 1e-12);
}

// Normal distributions that differ in their mean alone are that mean apart.
TEST(HistogramDistance, OfShiftedNoiseIsTheShift) {
  ImageF a(300, 300);
  ImageF b(200, 300);
  Rng rng(1, Stream::kTest, 4);
  for (ImageF* picture : {&a, &b}) {
    for (float& grey : picture->values()) {
      grey = static_cast<float>((picture == &a ? 0.4 : 0.47) + 0.05 * rng.normal());
    }
  }
  EXPECT_NEAR(histogram_distance(a, b), 0.07, 0.001);
  EXPECT_THROW(histogram_distance(a, b, Mask(300, 300)), ConfigError);
}

TEST(GreyMatch, RefusesPicturesOfDifferentSize) {
  const ImageF a = row_of({0.1F, 0.2F});
  const ImageF b = row_of({0.1F, 0.2F, 0.3F});
  EXPECT_THROW(match_exposure(a, b), ConfigError);
  EXPECT_THROW(correlation_of(a, b), ConfigError);
  EXPECT_THROW(residual_picture(a, a, Mask(3, 1)), ConfigError);
}

}  // namespace
}  // namespace glint
