// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/shape/equivalent_ellipse.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/rng.h"
#include "core/units.h"
#include "metrics/shape/shape_match.h"
#include "tests/metrics/shape/rendered_shapes.h"

namespace glint {
namespace {

using test::Pose;
using test::rendered;
using test::Shape;

// 6 x 2 pixels from (2, 3): centre (5, 4), xx = 36 / 12 = 3, yy = 4 / 12; axes 4 sqrt(3) = 6.93 and
// 4 / sqrt(3) = 2.31, elongation (3 - 1/3) / (3 + 1/3) = 0.8.
TEST(MomentsOf, MatchAHandWorkedRectangle) {
  Mask mask(12, 9);
  for (int y = 3; y < 5; ++y) {
    for (int x = 2; x < 8; ++x) {
      mask(x, y) = 1;
    }
  }
  const auto m = moments_of(mask);
  ASSERT_TRUE(m.has_value());
  EXPECT_NEAR(m->area_px, 12.0, 1e-12);
  EXPECT_NEAR(m->x_px, 5.0, 1e-12);
  EXPECT_NEAR(m->y_px, 4.0, 1e-12);
  EXPECT_NEAR(m->xx, 3.0, 1e-12);
  EXPECT_NEAR(m->xy, 0.0, 1e-12);
  EXPECT_NEAR(m->yy, 1.0 / 3.0, 1e-12);
  const EquivalentEllipse ellipse = ellipse_of(*m);
  EXPECT_NEAR(ellipse.length_px, 4.0 * std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(ellipse.width_px, 4.0 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(ellipse.angle_rad, 0.0, 1e-12);
  EXPECT_NEAR(ellipse.elongation, 0.8, 1e-12);
  EXPECT_NEAR(ellipse.skewness, 0.0, 1e-12);
}

// Weights 3 at x = 0.5 and 1 at x = 4.5: mean 1.5; xxx = (3 (-1)^3 + 3^3) / 4 = 6.
TEST(MomentsOf, MatchAHandWorkedThirdMoment) {
  ImageF weights(5, 1);
  weights(0, 0) = 3.0F;
  weights(4, 0) = 1.0F;
  const auto m = moments_of(weights);
  ASSERT_TRUE(m.has_value());
  EXPECT_NEAR(m->xxx, 6.0, 1e-12);
  EXPECT_NEAR(m->xx, 3.0 + 1.0 / 12.0, 1e-12);
  EXPECT_NEAR(ellipse_of(*m).skewness, 6.0 / std::pow(3.0 + 1.0 / 12.0, 1.5), 1e-12);
}

TEST(MomentsOf, OfNothingAreNone) {
  EXPECT_FALSE(moments_of(Mask(5, 5)).has_value());
  EXPECT_FALSE(moments_of(Mask()).has_value());
  EXPECT_FALSE(match_shapes(Mask(5, 5), Mask(5, 5, 1)).has_value());
  EXPECT_FALSE(match_shapes(Mask(5, 5, 1), Mask(5, 5)).has_value());
}

TEST(MomentsOf, RefuseWhatIsNoWeight) {
  ImageF weights(3, 3, 1.0F);
  weights(1, 1) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(moments_of(weights), ConfigError);
  weights(1, 1) = -0.1F;
  EXPECT_THROW(moments_of(weights), ConfigError);
}

// Moments against numerical sums about the centre, which share no formula with the shifts.
TEST(MomentsOf, AreThoseAboutTheCentre) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(1, Stream::kTest, i);
    ImageF weights(7, 6);
    for (float& w : weights.values()) {
      w = static_cast<float>(rng.uniform());
    }
    const auto m = moments_of(weights);
    ASSERT_TRUE(m.has_value());
    std::array<double, 5> sums = {};
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 7; ++x) {
        const double w = static_cast<double>(weights(x, y)) / m->area_px;
        const double u = x + 0.5 - m->x_px;
        const double v = y + 0.5 - m->y_px;
        const std::array<double, 5> terms = {u * v, u * u * u, u * u * v, u * v * v, v * v * v};
        for (std::size_t k = 0; k < 5; ++k) {
          sums[k] += w * terms[k];
        }
      }
    }
    EXPECT_NEAR(m->xy, sums[0], 1e-10);
    EXPECT_NEAR(m->xxx, sums[1], 1e-10);
    EXPECT_NEAR(m->xxy, sums[2], 1e-10);
    EXPECT_NEAR(m->xyy, sums[3], 1e-10);
    EXPECT_NEAR(m->yyy, sums[4], 1e-10);
  }
}

// The printed tan 2a = 2 mu11 / (mu02 - mu20) would give -30 degrees.
TEST(EllipseOf, TurnsFromXToYDownwards) {
  const Shape ellipse = [](double x, double y) { return x * x + 4.0 * y * y <= 1.0; };
  for (int degrees = -85; degrees <= 90; degrees += 5) {
    const Pose pose{
        .x_px = 60.0, .y_px = 61.0, .angle_rad = degrees * kRadPerDeg, .scale_px = 50.0};
    const auto m = moments_of(rendered(ellipse, pose, 120, 120));
    ASSERT_TRUE(m.has_value());
    const EquivalentEllipse found = ellipse_of(*m);
    EXPECT_NEAR(std::remainder(found.angle_rad - pose.angle_rad, kPi), 0.0, 1e-3) << degrees;
    EXPECT_GT(found.angle_rad, -0.5 * kPi);
    EXPECT_LE(found.angle_rad, 0.5 * kPi);
    EXPECT_NEAR(found.length_px, 100.0, 0.05);
    EXPECT_NEAR(found.width_px, 50.0, 0.05);
  }
}

}  // namespace
}  // namespace glint
