// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan/clipped_stripe.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/render/scan/clipped_mean.h"

namespace glint {
namespace {

/// Mean over a period by the trapezoidal rule on either side of the kinks where it clips.
double mean_by_steps(const BlurredStripe& stripe, double slope, double offset) {
  // The stripe falls from its middle on and is even about it: half a period is enough. The place
  // where it clips is found to 1e-15 by halving and both sides are integrated by Simpson's rule.
  const double middle = 0.5 * stripe.duty;
  const auto value = [&](double phase) { return offset + slope * stripe.at(phase); };
  double low = middle;
  double high = middle + 0.5;
  for (int i = 0; i < 60; ++i) {
    const double half = 0.5 * (low + high);
    (value(half) > 1.0 ? low : high) = half;
  }
  const double from = value(middle) > 1.0 ? low : middle;
  const int pieces = 4000;
  const double step = (middle + 0.5 - from) / pieces;
  double sum = 0.0;
  for (int i = 0; i < pieces; ++i) {
    const double left = from + i * step;
    sum += step / 6.0 *
           (std::min(1.0, value(left)) + 4.0 * std::min(1.0, value(left + 0.5 * step)) +
            std::min(1.0, value(left + step)));
  }
  return 2.0 * ((from - middle) + sum);
}

TEST(ClippedMeanOf, AgreesWithNumericIntegration) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(83, Stream::kTest, i);
    const BlurredStripe stripe = {.duty = rng.uniform(0.05, 0.95), .w = rng.uniform(0.02, 0.7)};
    const double slope = rng.uniform(0.2, 5.0);
    const double offset = rng.uniform(0.0, 0.8);
    EXPECT_NEAR(clipped_mean_of(stripe, slope, offset), mean_by_steps(stripe, slope, offset), 1e-10)
        << stripe.duty << " " << stripe.w << " " << slope << " " << offset;
  }
}

// No blur: duty min(1, offset + slope) + (1 - duty) offset = 0.3 x 1 + 0.7 x 0.2 = 0.44.
TEST(ClippedMeanOf, SharpStripesHaveTwoLevels) {
  EXPECT_NEAR(clipped_mean_of({.duty = 0.3, .w = 0.0}, 2.0, 0.2), 0.44, 1e-14);
  EXPECT_NEAR(clipped_mean_of({.duty = 0.3, .w = 1e-4}, 2.0, 0.2), 0.44, 1e-3);
}

// All blurred away: 0.1 + 2 x 0.3 = 0.7, and full scale where that is above it.
TEST(ClippedMeanOf, BlurredAwayItIsTheMean) {
  EXPECT_NEAR(clipped_mean_of({.duty = 0.3, .w = 2.0}, 2.0, 0.1), 0.7, 1e-14);
  EXPECT_DOUBLE_EQ(clipped_mean_of({.duty = 0.3, .w = 2.0}, 5.0, 0.1), 1.0);
}

TEST(ClippedMeanOf, WithoutClippingTheBlurDoesNotMatter) {
  for (const double w : {0.0, 0.01, 0.1, 0.5}) {
    EXPECT_NEAR(clipped_mean_of({.duty = 0.4, .w = w}, 0.8, 0.15), 0.47, 1e-14) << w;
  }
}

// The middle of a wide stripe is at 1, half a period away at 0, and either edge at one half.
TEST(BlurredStripe, IsAHalfAtItsEdges) {
  const BlurredStripe stripe = {.duty = 0.5, .w = 0.02};
  EXPECT_NEAR(stripe.at(0.25), 1.0, 1e-12);
  EXPECT_NEAR(stripe.at(0.75), 0.0, 1e-12);
  EXPECT_NEAR(stripe.at(0.0), 0.5, 1e-12);
  EXPECT_NEAR(stripe.at(0.5), 0.5, 1e-12);
  // Steepest there: the Gaussian's height, 1 / (w sqrt(2 pi)) = 19.9471.
  EXPECT_NEAR(stripe.slope(0.5), -19.9471, 1e-4);
  // Half the stripe's area lies beyond its middle.
  EXPECT_NEAR(stripe.integral(0.75), 0.25, 1e-12);
}

TEST(BlurredStripe, AgreesWithTheTablesOwnStripe) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(89, Stream::kTest, i);
    const double duty = rng.uniform(0.05, 0.95);
    const double w = rng.uniform(0.01, 0.8);
    const double phase = 0.5 * duty + rng.uniform(0.0, 0.5);
    EXPECT_NEAR(
        (BlurredStripe{.duty = duty, .w = w}.at(phase)), blurred_stripe(phase, duty, w), 1e-9);
  }
}

TEST(StripeSeries, IsTheStripeByItsEdges) {
  for (const double w : {0.04, 0.1, 0.3}) {
    for (const double duty : {0.2, 0.5, 0.83}) {
      const BlurredStripe stripe = {.duty = duty, .w = w};
      const StripeSeries series(stripe, 1e-17);
      double phase = 0.5 * duty;
      while (phase < 0.5 * duty + 0.5) {
        const StripeSeries::Point point = series.at(phase);
        EXPECT_NEAR(point.value, stripe.at(phase), 1e-13) << w;
        EXPECT_NEAR(point.slope, stripe.slope(phase), 1e-11) << w;
        EXPECT_NEAR(point.integral, stripe.integral(phase), 1e-13) << w;
        phase += 0.03;
      }
    }
  }
}

}  // namespace
}  // namespace glint
