// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/defect_contrast.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

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

struct DiscDrawing {
  double contrast = 0.0;
  double slope_per_px = 0.0;  ///< of the light, growing to the right
  double fall = 0.0;          ///< share of the light that is lost 18 px from the middle, as r^2
  double halves = 0.0;        ///< the right half is brighter by this contrast, the left one darker
};

/// A disc on a ground.
ImageF drawn_disc(const DiscDrawing& drawing) {
  ImageF picture(80, 64);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const Eigen::Vector2d at(x + 0.5, y + 0.5);
      const double radius = (at - disc().middle_px()).norm() / 18.0;
      const double around =
          kAround * (1.0 - drawing.fall * radius * radius) + drawing.slope_per_px * (at.x() - 40.0);
      const double half = at.x() > 40.0 ? drawing.halves : -drawing.halves;
      const double share = disc().distance_px(at) <= 6.0 ? drawing.contrast + half : 0.0;
      picture(x, y) = static_cast<float>(around + kAround * share);
    }
  }
  return picture;
}

/// A part that ends at a column.
Mask part_to(int end_px) {
  Mask region(80, 64);
  for (int y = 0; y < region.height(); ++y) {
    std::fill_n(region.row(y), end_px, std::uint8_t{1});
  }
  return region;
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
int held_of_200(const DiscDrawing& drawing, int side, const Mask& region = {}) {
  int held = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    ImageF picture = drawn_disc(drawing);
    add_noise(picture, 0.02, side, i);
    const auto found = defect_contrast(picture, region, disc());
    held += found && found->low <= drawing.contrast && drawing.contrast <= found->high ? 1 : 0;
  }
  return held;
}

// 0.5 on 0.4 is 0.5 / 0.4 - 1 = 0.25.
TEST(DefectContrast, IsThatOfTheMeansInsideAndAround) {
  const auto found = defect_contrast(drawn_disc({.contrast = 0.25}), {}, disc());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value, 0.25, 1e-6);
  EXPECT_NEAR(found->high - found->low, 0.0, 1e-6);
}

// Uneven light is no noise: the interval stays as narrow, and the value what it is.
TEST(DefectContrast, LeavesTheSlopeOfTheLightOut) {
  const auto found =
      defect_contrast(drawn_disc({.contrast = 0.25, .slope_per_px = 0.002}), {}, disc());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value, 0.25, 1e-4);
  EXPECT_LT(found->high - found->low, 1e-3);
}

// A dent that is bright on one side and dark on the other, in light that falls by 5 % over 18 px:
// neither is noise. Noise of 0.5 % makes means of 113 pixels uncertain by 0.0005, of the light
// under them by about as much.
TEST(DefectContrast, TakesNeitherCurvatureNorTheDefectsStructureForNoise) {
  ImageF picture = drawn_disc({.fall = 0.05, .halves = 0.3});
  const auto quiet = defect_contrast(picture, {}, disc());
  ASSERT_TRUE(quiet);
  EXPECT_NEAR(quiet->value, 0.0, 1e-4);
  EXPECT_LT(quiet->high - quiet->low, 1e-4);
  add_noise(picture, 0.005 * kAround, 1, 1);
  const auto noisy = defect_contrast(picture, {}, disc());
  ASSERT_TRUE(noisy);
  EXPECT_NEAR(noisy->value, 0.0, 0.004);
  EXPECT_LT(noisy->high - noisy->low, 0.005);
  EXPECT_GT(noisy->high - noisy->low, 0.002);
}

// The pixels around lie 1.8 px to the left of the disc in the mean, where it is darker.
TEST(DefectContrast, LeavesTheSlopeOutWhereThePartEndsBesideTheDefect) {
  const DiscDrawing drawing = {.slope_per_px = 0.005 * kAround};
  const auto found = defect_contrast(drawn_disc(drawing), part_to(46), disc());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value, 0.0, 1e-4);
  EXPECT_LT(found->high - found->low, 1e-4);
}

// 95 % of 200 is 190, with a standard deviation of 3.
TEST(DefectContrast, HasAnIntervalThatHoldsTheTruthNineteenTimesOfTwenty) {
  for (const double contrast : {-0.3, 0.0, 0.25}) {
    const DiscDrawing drawing = {.contrast = contrast, .slope_per_px = 0.001, .fall = 0.05};
    const int held = held_of_200(drawing, 1);
    EXPECT_GE(held, 180) << contrast;
    EXPECT_LE(held, 198) << contrast;
    const int beside = held_of_200(drawing, 1, part_to(46));
    EXPECT_GE(beside, 180) << contrast;
    EXPECT_LE(beside, 198) << contrast;
  }
}

// As in pictures of colour sensors, and of metal with a texture.
TEST(DefectContrast, HasSuchAnIntervalWhereNeighboursAreAlike) {
  for (const int side : {2, 3}) {
    const int held =
        held_of_200({.contrast = 0.25, .slope_per_px = 0.001, .fall = 0.05, .halves = 0.2}, side);
    EXPECT_GE(held, 178) << side;
    EXPECT_LE(held, 199) << side;
  }
}

TEST(DefectContrast, IsNotToldWhereTooLittleOfEitherIsInThePart) {
  const ImageF picture = drawn_disc({.contrast = 0.25});
  Mask region(80, 64);
  EXPECT_FALSE(defect_contrast(picture, region, disc()));
  for (int y = 0; y < region.height(); ++y) {
    for (int x = 0; x < region.width(); ++x) {
      region(x, y) = disc().distance_px({x + 0.5, y + 0.5}) <= 6.0 ? 1 : 0;
    }
  }
  EXPECT_FALSE(defect_contrast(picture, region, disc()));
  // Two columns do not tell how the light curves along rows.
  for (int y = 0; y < region.height(); ++y) {
    region(28, y) = region(29, y) = 1;
  }
  EXPECT_FALSE(defect_contrast(picture, region, disc()));
  for (int y = 0; y < region.height(); ++y) {
    region(27, y) = 1;
  }
  EXPECT_TRUE(defect_contrast(picture, region, disc()));
}

}  // namespace
}  // namespace glint
