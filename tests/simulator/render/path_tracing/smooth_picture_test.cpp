// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/path_tracing/smooth_picture.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

constexpr int kWidth = 60;
constexpr int kHeight = 40;
constexpr double kNoise = 0.05;  ///< of each rendering

/// Two flat faces that meet in column 30, the right one turned by 45 degrees; column 0 is no part.
struct FoldedPart {
  SurfaceImages surface;
  CoverageImages coverage;

  FoldedPart() {
    for (auto image : {&SurfaceImages::depth_mm,
                       &SurfaceImages::normal_x,
                       &SurfaceImages::normal_y,
                       &SurfaceImages::normal_z,
                       &SurfaceImages::x_mm,
                       &SurfaceImages::y_mm,
                       &SurfaceImages::z_mm}) {
      surface.*image = ImageF(kWidth, kHeight);
    }
    coverage.background = ImageF(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const float beyond = static_cast<float>(std::max(0, x - 30));
        surface.x_mm(x, y) = static_cast<float>(x);
        surface.y_mm(x, y) = static_cast<float>(y);
        surface.z_mm(x, y) = -beyond;
        surface.normal_x(x, y) = beyond > 0.0F ? std::sqrt(0.5F) : 0.0F;
        surface.normal_z(x, y) = beyond > 0.0F ? std::sqrt(0.5F) : 1.0F;
        coverage.background(x, y) = x == 0 ? 1.0F : 0.0F;
      }
    }
  }
};

/// A picture and two renderings of it with independent noise.
struct NoisyPicture {
  ImageF truth = ImageF(kWidth, kHeight);
  RenderedTwice rendered = {ImageF(kWidth, kHeight), ImageF(kWidth, kHeight)};

  template <class Value>
  explicit NoisyPicture(const Value& value_at) {
    Rng rng(1, Stream::kTest, 0);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        truth(x, y) = static_cast<float>(value_at(x, y));
        for (ImageF& one : rendered) {
          one(x, y) = truth(x, y) + static_cast<float>(kNoise * rng.normal());
        }
      }
    }
  }

  /// Root mean square error of the mean of both, from column `first` on up to `end`.
  double error(int first = 1, int end = kWidth) const {
    double sum = 0.0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = first; x < end; ++x) {
        const float off = 0.5F * (rendered[0](x, y) + rendered[1](x, y)) - truth(x, y);
        sum += static_cast<double>(off) * static_cast<double>(off);
      }
    }
    return std::sqrt(sum / (kHeight * (end - first)));
  }

  void smooth_on(const FoldedPart& part) {
    ThreadPool pool(2);
    smooth(part.surface, part.coverage, {&rendered, 1}, pool);
  }
};

// Shading that is of second degree on each face, with a step where they meet.
double shaded(int x, int y) {
  return x <= 30 ? 0.3 + 0.004 * x + 1e-4 * y * y : 0.9 - 1e-4 * x * y;
}

TEST(Smooth, TakesNoiseOffAndKeepsTheStepBetweenFaces) {
  NoisyPicture picture(shaded);
  const double before = picture.error();
  EXPECT_NEAR(before, kNoise / std::sqrt(2.0), 0.002);
  picture.smooth_on(FoldedPart());
  EXPECT_LT(picture.error(), 0.35 * before);
  EXPECT_LT(picture.error(28, 34), 0.6 * before);  // beside the step fits are one-sided
}

TEST(Smooth, KeepsAPatternThatBothRenderingsShow) {
  NoisyPicture picture([](int x, int y) { return 0.5 + ((x / 2 + y / 2) % 2 == 0 ? 0.2 : -0.2); });
  const double before = picture.error();
  picture.smooth_on(FoldedPart());
  EXPECT_LT(picture.error(), 1.2 * before);
}

TEST(Smooth, LeavesPixelsBesideThePartAlone) {
  NoisyPicture picture(shaded);
  const RenderedTwice before = picture.rendered;
  picture.smooth_on(FoldedPart());
  for (int y = 0; y < kHeight; ++y) {
    EXPECT_EQ(picture.rendered[0](0, y), before[0](0, y));
    EXPECT_NE(picture.rendered[0](1, y), before[0](1, y));
  }
}

// Sums over 100 numbers scatter by 2 / sqrt(100) = 0.2: a share of 0.6 is (0.6 - 0.2) / 0.8.
TEST(AgreedShare, LeavesOutWhatChanceAgreesOn) {
  EXPECT_DOUBLE_EQ(agreed_share(60.0, 100.0, 100.0), 0.5);
  EXPECT_DOUBLE_EQ(agreed_share(100.0, 100.0, 100.0), 1.0);
  EXPECT_EQ(agreed_share(15.0, 100.0, 100.0), 0.0);
  EXPECT_EQ(agreed_share(-50.0, 100.0, 100.0), 0.0);
  EXPECT_DOUBLE_EQ(agreed_share(1.0, 1.0, 1.0), 1.0);  // few numbers: half counts as chance
  EXPECT_DOUBLE_EQ(agreed_share(0.0, 0.0, 0.0), 1.0);  // nothing to disagree on
}

}  // namespace
}  // namespace glint
