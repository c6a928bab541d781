// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/aspect_image/fringe.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

ImageF frame_of(int width_px, int height_px, const std::function<double(double)>& value) {
  ImageF frame(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      frame(x, y) = static_cast<float>(value(x + 0.5));
    }
  }
  return frame;
}

double share_of_period(double x, double period_px) {
  return x / period_px - std::floor(x / period_px);
}

Mask everywhere(const ImageF& frame) {
  return {frame.width(), frame.height(), 1};
}

TEST(FringeScores, FindNoIrregularityInExactStripes) {
  const ImageF frame =
      frame_of(100, 3, [](double x) { return share_of_period(x, 10.0) < 0.4 ? 0.9 : 0.1; });
  const auto scores = fringe_scores(frame, everywhere(frame), {.nominal_duty = 0.5});
  ASSERT_TRUE(scores.has_value());
  EXPECT_NEAR(scores->regularity, 0.0, 1e-7);
  EXPECT_NEAR(scores->period_px, 10.0, 1e-9);
  EXPECT_NEAR(scores->duty, 0.4, 1e-7);
  EXPECT_NEAR(scores->duty_error, -0.1, 1e-7);
  EXPECT_NEAR(scores->modulation, 0.8, 1e-6);
  // Edges at 4, 10, 14, ... 90, 94 in each row: 19 edges, 17 spacings of two.
  EXPECT_EQ(scores->periods, 3 * 17);
}

// Edges of sin(2 pi phi), phi = ln(1 + x / s) / ln q, lie at x_j = s (q^(j/2) - 1): spacings of two
// form a geometric series of ratio r = sqrt(q), whose mean square over squared mean is
// n (r^2n - 1) (r - 1)^2 / ((r^2 - 1) (r^n - 1)^2).
TEST(FringeScores, MeasureAChirpAsItsClosedForm) {
  constexpr double kScalePx = 500.0;
  constexpr double kRatio = 1.06;
  const ImageF frame = frame_of(1190, 2, [](double x) {
    const double phase = std::log(1.0 + x / kScalePx) / std::log(kRatio);
    return 0.5 + 0.5 * std::sin(2.0 * kPi * phase);
  });
  const auto scores = fringe_scores(frame, everywhere(frame));
  ASSERT_TRUE(scores.has_value());
  ASSERT_EQ(scores->periods % 2, 0);
  const int n = scores->periods / 2;
  EXPECT_EQ(n, 39);  // phi(1190) = 20.9: 41 edges at 0.5, 1 ... 20.5; all but two start a spacing
  const double r = std::sqrt(kRatio);
  const double square_ratio = n * (std::pow(r, 2 * n) - 1) * (r - 1) * (r - 1) /
                              ((r * r - 1) * std::pow(std::pow(r, n) - 1, 2));
  EXPECT_NEAR(scores->regularity, std::sqrt(square_ratio - 1.0), 2e-3);
  EXPECT_GT(scores->regularity, 0.3);
}

TEST(FringeScores, FindSubPixelEdgesOfBlurredStripes) {
  const ImageF frame =
      frame_of(400, 1, [](double x) { return 0.5 + 0.4 * std::sin(2.0 * kPi * x / 13.7); });
  const auto scores = fringe_scores(frame, everywhere(frame));
  ASSERT_TRUE(scores.has_value());
  EXPECT_NEAR(scores->period_px, 13.7, 0.02);
  EXPECT_LT(scores->regularity, 0.005);  // edges to whole pixels would scatter by 0.03
  EXPECT_NEAR(scores->duty, 0.5, 0.01);
}

TEST(FringeScores, DoNotMeasureAcrossAHoleInTheRegion) {
  // The stripes jump by half a period where the region has a hole.
  const ImageF frame = frame_of(200, 1, [](double x) {
    return share_of_period(x < 100 ? x : x + 5.0, 10.0) < 0.5 ? 1.0 : 0.0;
  });
  Mask region = everywhere(frame);
  EXPECT_GT(fringe_scores(frame, region)->regularity, 0.05);
  for (int x = 95; x < 106; ++x) {
    region(x, 0) = 0;
  }
  EXPECT_NEAR(fringe_scores(frame, region)->regularity, 0.0, 1e-7);
}

TEST(FringeScores, TakeNoiseForNoEdges) {
  Rng rng(9, Stream::kTest, 0);
  const auto stripes = [](double x) { return 0.5 + 0.4 * std::sin(2.0 * kPi * x / 40.0); };
  const ImageF clean = frame_of(1000, 20, stripes);
  ImageF noisy = clean;
  for (float& value : noisy.values()) {
    value += static_cast<float>(rng.uniform(-0.05, 0.05));
  }
  const auto with_noise = fringe_scores(noisy, everywhere(noisy));
  EXPECT_EQ(with_noise->periods, fringe_scores(clean, everywhere(clean))->periods);
  EXPECT_LT(with_noise->regularity, 0.05);
  const auto without_hysteresis = fringe_scores(noisy, everywhere(noisy), {.hysteresis = 0.0});
  EXPECT_GT(without_hysteresis->periods, with_noise->periods);
}

TEST(FringeScores, AreEmptyWithoutThreeEdgesInARow) {
  const ImageF flat(100, 4, 0.5f);
  EXPECT_FALSE(fringe_scores(flat, everywhere(flat)).has_value());
  const ImageF bar = frame_of(100, 4, [](double x) { return x > 30 && x < 60 ? 1.0 : 0.0; });
  EXPECT_FALSE(fringe_scores(bar, everywhere(bar)).has_value());
  const ImageF black(100, 4);
  EXPECT_FALSE(fringe_scores(black, everywhere(black)).has_value());
  EXPECT_FALSE(fringe_scores(bar, Mask(100, 4)).has_value());
}

}  // namespace
}  // namespace glint
