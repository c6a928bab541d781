// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/defect_contrast.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/metrics/overlap/drawn_edges.h"

namespace glint {
namespace {

constexpr double kAround = 0.4;

const KnownDefect& disc() {
  static const KnownDefect defect = {
      .from_px = {40.0, 32.0}, .to_px = {40.0, 32.0}, .radius_px = 6.0};
  return defect;
}

/// A disc of one grey on a ground that grows brighter to the right.
ImageF drawn_disc(double contrast, double slope_per_px = 0.0) {
  ImageF picture(80, 64);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const double around = kAround + slope_per_px * (x + 0.5 - 40.0);
      const double share = disc().distance_px({x + 0.5, y + 0.5}) <= 6.0 ? contrast : 0.0;
      picture(x, y) = static_cast<float>(around + kAround * share);
    }
  }
  return picture;
}

/// Normal noise of one sigma a pixel, which the mean of side x side pixels makes neighbours share.
void add_noise(ImageF& picture, double sigma, int side, std::uint64_t index) {
  ImageF noise(picture.width() + side, picture.height() + side, 0.5F);
  add_normal_noise(noise, sigma, index);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      double sum = 0.0;
      for (int i = 0; i < side * side; ++i) {
        sum += static_cast<double>(noise(x + i % side, y + i / side)) - 0.5;
      }
      picture(x, y) += static_cast<float>(sum / side);
    }
  }
}

/// Of 200 draws, how many intervals hold the truth.
int held_of_200(double contrast, int side, double slope_per_px) {
  int held = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    ImageF picture = drawn_disc(contrast, slope_per_px);
    add_noise(picture, 0.02, side, i);
    const auto found = defect_contrast(picture, {}, disc());
    held += found && found->low <= contrast && contrast <= found->high ? 1 : 0;
  }
  return held;
}

// 0.5 on 0.4 is 0.5 / 0.4 - 1 = 0.25.
TEST(DefectContrast, IsThatOfTheMeansInsideAndAround) {
  const auto found = defect_contrast(drawn_disc(0.25), {}, disc());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value, 0.25, 1e-6);
  EXPECT_NEAR(found->high - found->low, 0.0, 1e-6);
}

// Uneven light is no noise: the interval stays as narrow, and the value what it is.
TEST(DefectContrast, LeavesTheSlopeOfTheLightOut) {
  const auto found = defect_contrast(drawn_disc(0.25, 0.002), {}, disc());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value, 0.25, 1e-4);
  EXPECT_LT(found->high - found->low, 1e-3);
}

// 95 % of 200 is 190, with a standard deviation of 3.
TEST(DefectContrast, HasAnIntervalThatHoldsTheTruthNineteenTimesOfTwenty) {
  for (const double contrast : {-0.3, 0.0, 0.25}) {
    const int held = held_of_200(contrast, 1, 0.001);
    EXPECT_GE(held, 180) << contrast;
    EXPECT_LE(held, 198) << contrast;
  }
}

// As in pictures of colour sensors, and of metal with a texture.
TEST(DefectContrast, HasSuchAnIntervalWhereNeighboursAreAlike) {
  for (const int side : {2, 3}) {
    const int held = held_of_200(0.25, side, 0.001);
    EXPECT_GE(held, 178) << side;
    EXPECT_LE(held, 199) << side;
  }
}

TEST(DefectContrast, IsNotToldWhereTooLittleOfEitherIsInThePart) {
  Mask region(80, 64);
  EXPECT_FALSE(defect_contrast(drawn_disc(0.25), region, disc()));
  for (int y = 0; y < region.height(); ++y) {
    for (int x = 0; x < region.width(); ++x) {
      region(x, y) = disc().distance_px({x + 0.5, y + 0.5}) <= 6.0 ? 1 : 0;
    }
  }
  EXPECT_FALSE(defect_contrast(drawn_disc(0.25), region, disc()));
}

}  // namespace
}  // namespace glint
