// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/corner_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

/// Two edges through a point, blurred by a Gaussian; in double precision.
struct Corner {
  Eigen::Vector2d at_px = {40.3, 39.6};
  double angle1_rad = 0.2;  ///< of the normal of the first edge
  double angle2_rad = 1.6;
  double blur_px = 1.0;
  double low = 0.2;
  double high = 0.8;

  double grey(double x, double y) const {
    const auto edge = [&](double angle) {
      const double d = std::cos(angle) * (x - at_px.x()) + std::sin(angle) * (y - at_px.y());
      return std::erf(d / (std::sqrt(2.0) * blur_px));
    };
    return 0.5 * (low + high) + 0.5 * (high - low) * edge(angle1_rad) * edge(angle2_rad);
  }

  ImageF picture(double noise, Rng& rng) const {
    ImageF image(80, 80);
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 80; ++x) {
        image(x, y) = static_cast<float>(grey(x + 0.5, y + 0.5) + noise * rng.normal());
      }
    }
    return image;
  }

  /// Both normals point to bright, so the edges bound the quadrant between them.
  CornerGuess guess() const {
    const Eigen::Vector2d n1(std::cos(angle1_rad), std::sin(angle1_rad));
    const Eigen::Vector2d n2(std::cos(angle2_rad), std::sin(angle2_rad));
    const Eigen::Vector2d edge1(-n1.y(), n1.x());
    const Eigen::Vector2d edge2(-n2.y(), n2.x());
    return {.at_px = at_px + Eigen::Vector2d(0.6, -0.5),
            .rising = edge2.dot(n1) > 0.0 ? edge2 : Eigen::Vector2d(-edge2),
            .falling = edge1.dot(n2) > 0.0 ? edge1 : Eigen::Vector2d(-edge1),
            .clearance_px = 60.0};
  }
};

TEST(FitCorner, FindsAnExactCornerItsBlurAndItsContrast) {
  Rng rng(1, Stream::kTest, 0);
  for (const double blur : {0.5, 1.0, 2.0, 5.0}) {
    const Corner corner = {.blur_px = blur};
    const Pixels pixels = corner.picture(0.0, rng);
    PictureLevels levels(pixels);
    const auto fit = fit_corner(levels, 0, corner.guess());
    ASSERT_TRUE(fit.has_value()) << blur;
    EXPECT_LT((fit->at_px - corner.at_px).norm(), 0.003) << blur;
    EXPECT_NEAR(fit->blur_px, blur, 0.02 * blur + 0.01);
    EXPECT_NEAR(fit->contrast, 0.6, 0.01);
  }
}

TEST(FitCorner, ScattersUnderNoiseAsItsWindowPromises) {
  // Noise 0.03, step 0.6: (0.03 / (0.6 x 0.018))^2 sqrt(pi) = 13.7 px of an edge blurred by 1 px;
  // 12 px are allowed, which gives 0.018 sqrt(13.7 / 12) = 0.019 px across each edge. The corner
  // itself, where edges fade, and the other unknowns cost some more.
  Rng rng(2, Stream::kTest, 0);
  const Corner corner = {.angle1_rad = 0.3, .angle2_rad = 0.3 + kPi / 2};
  double squares = 0.0;
  constexpr int kTrials = 300;
  for (int i = 0; i < kTrials; ++i) {
    const Pixels pixels = corner.picture(0.03, rng);
    PictureLevels levels(pixels);
    const auto fit = fit_corner(levels, 0, corner.guess());
    ASSERT_TRUE(fit.has_value());
    EXPECT_GT(fit->window_px, 9.0);
    squares += (fit->at_px - corner.at_px).squaredNorm();
  }
  const double per_axis = std::sqrt(squares / (2.0 * kTrials));
  EXPECT_GT(per_axis, 0.017);
  EXPECT_LT(per_axis, 0.027);
}

TEST(FitCorner, TakesASmallWindowWithoutNoise) {
  Rng rng(3, Stream::kTest, 0);
  const Corner corner;
  const Pixels pixels = corner.picture(0.001, rng);
  PictureLevels levels(pixels);
  EXPECT_LE(fit_corner(levels, 0, corner.guess())->window_px, 6.0);
}

TEST(FitCorner, MeasuresCornersBesideTheBorder) {
  // The window is narrower there, by as much on either side: an exact corner stays exact.
  Rng rng(5, Stream::kTest, 0);
  for (const Eigen::Vector2d& at_px :
       {Eigen::Vector2d(4.2, 39.6), Eigen::Vector2d(40.3, 75.1), Eigen::Vector2d(74.9, 5.0)}) {
    for (const double blur : {0.5, 1.0, 2.0}) {
      const Corner corner = {.at_px = at_px, .blur_px = blur};
      const Pixels pixels = corner.picture(0.0, rng);
      PictureLevels levels(pixels);
      const auto fit = fit_corner(levels, 0, corner.guess());
      ASSERT_TRUE(fit.has_value()) << at_px.transpose() << ", " << blur;
      EXPECT_LT((fit->at_px - corner.at_px).norm(), 0.005) << at_px.transpose() << ", " << blur;
      EXPECT_NEAR(fit->blur_px, blur, 0.03 * blur + 0.01);
    }
  }
}

TEST(FitCorner, HasNoAnswerWhereThereIsNoCorner) {
  const Pixels flat = ImageF(80, 80, 0.5F);
  PictureLevels levels(flat);
  const auto fit = fit_corner(levels, 0, Corner().guess());
  EXPECT_TRUE(!fit.has_value() || std::abs(fit->contrast) < 1e-3);
  Rng rng(4, Stream::kTest, 0);
  const Corner corner;
  const Pixels pixels = corner.picture(0.0, rng);
  PictureLevels with_corner(pixels);
  CornerGuess outside = corner.guess();
  outside.at_px = {1.0, 40.0};
  EXPECT_FALSE(fit_corner(with_corner, 0, outside).has_value());
}

TEST(PictureLevels, AreMeansWithTheSamePoints) {
  Image<std::uint8_t> image(6, 4, 0);
  image(2, 2) = 255;
  image(3, 2) = 255;
  image(2, 3) = 255;
  const Pixels pixels = image;
  PictureLevels levels(pixels);
  EXPECT_EQ(levels.level(1).width(), 3);
  EXPECT_FLOAT_EQ(levels.level(1)(1, 1), 0.75F);
  EXPECT_FLOAT_EQ(levels.part(0, 2, 2, 2, 2)(1, 0), 1.0F);
  EXPECT_FLOAT_EQ(levels.level(2)(0, 0), 3.0F / 16.0F);  // pixels 0 to 3 of both axes
}

}  // namespace
}  // namespace glint
