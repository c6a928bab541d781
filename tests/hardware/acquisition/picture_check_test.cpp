// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/acquisition/picture_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/rng.h"

namespace glint {
namespace {

using testing::HasSubstr;

Frame frame_of(int width, int height, const std::function<double(int, int)>& level) {
  Frame frame;
  frame.status = FrameStatus::kComplete;
  frame.codes = Image<std::uint16_t>(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      frame.codes(x, y) =
          static_cast<std::uint16_t>(std::lround(std::clamp(level(x, y), 0.0, 255.0)));
    }
  }
  return frame;
}

// Columns of 50 and 150 in turn, 4 wide, 64 x 48: the mean is 100; one in four differences along a
// row is 100, none along a column: 15 of 63 along each of 47 rows, halved: (100^2 * 15 / 63) / 2 =
// 1190.5, over 100^2: 0.119. Second differences in both directions are 0: no noise.
TEST(FiguresOf, AreThoseOfStripes) {
  const PictureFigures figures =
      figures_of(frame_of(64, 48, [](int x, int) { return x / 4 % 2 == 0 ? 50 : 150; }), {});
  EXPECT_NEAR(figures.mean, 100.0 / 255.0, 1e-12);
  EXPECT_NEAR(figures.bright, 150.0 / 255.0, 1e-12);
  EXPECT_EQ(figures.clipped_share, 0.0);
  EXPECT_NEAR(figures.sharpness, 0.11905, 1e-4);
  EXPECT_EQ(figures.outline_share, 1.0);
}

TEST(FiguresOf, SharpnessFallsWithBlurAndNotWithExposureOrNoise) {
  Rng random(1, Stream::kTest, 0);
  const auto sharpness = [&](double width_px, double gain) {
    return figures_of(frame_of(200,
                               200,
                               [&](int x, int) {
                                 const double wave = std::tanh(std::sin(0.2 * x) * 5.0 / width_px);
                                 return gain * (100.0 + 60.0 * wave) + 2.0 * random.normal();
                               }),
                      {})
        .sharpness;
  };
  const double sharp = sharpness(1.0, 1.0);
  EXPECT_LT(sharpness(3.0, 1.0), 0.6 * sharp);
  EXPECT_NEAR(sharpness(1.0, 0.5), sharp, 0.1 * sharp);
}

TEST(RejectionOf, NamesWhatIsWrong) {
  const PictureLimits limits;
  const PictureFigures good = {.mean = 0.3, .bright = 0.8, .sharpness = 0.1};
  EXPECT_EQ(rejection_of(good, limits, 0.0), "");
  EXPECT_EQ(rejection_of(good, limits, 0.12), "");
  EXPECT_THAT(rejection_of(good, limits, 0.2), HasSubstr("blurred"));
  PictureFigures bad = good;
  bad.bright = 0.03;
  EXPECT_THAT(rejection_of(bad, limits, 0.0), HasSubstr("too dark"));
  bad = good;
  bad.clipped_share = 0.4;
  EXPECT_THAT(rejection_of(bad, limits, 0.0), HasSubstr("40.0 % of the pixels are clipped"));
  bad = good;
  bad.outline_share = 0.2;
  EXPECT_THAT(rejection_of(bad, limits, 0.0), HasSubstr("not in view"));
  EXPECT_THAT(rejection_of(good, {.min_sharpness = 0.2}, 0.0), HasSubstr("blurred"));
}

TEST(FiguresOf, SeeThePartWhereItShouldBeAndMissItElsewhere) {
  Mask expected(60, 40);
  for (int y = 10; y < 30; ++y) {
    for (int x = 20; x < 40; ++x) {
      expected(x, y) = 1;
    }
  }
  const auto part_at = [](int x0) {
    return frame_of(60, 40, [x0](int x, int y) {
      return x >= x0 && x < x0 + 20 && y >= 10 && y < 30 ? 120.0 : 20.0;
    });
  };
  EXPECT_GT(figures_of(part_at(20), {.part = expected}).outline_share, 0.99);
  EXPECT_LT(figures_of(part_at(0), {.part = expected}).outline_share, 0.35);
}

/// A bright square whose edges are Gaussian steps of that sigma, with noise of one code, 12 px from
/// where it is expected; the right half of the background rises evenly.
Frame soft_square(double sigma_px) {
  Rng random(4, Stream::kTest, 0);
  const auto step = [](double from_px, double sigma) {
    return 0.5 * (1.0 + std::erf(from_px / (std::sqrt(2.0) * sigma)));
  };
  return frame_of(300, 240, [&](int x, int y) {
    const double along_x = step(x - 92.0, sigma_px) * step(212.0 - x, sigma_px);
    const double along_y = step(y - 60.0, sigma_px) * step(180.0 - y, sigma_px);
    return 20.0 + 0.1 * std::max(0, x - 150) + 140.0 * along_x * along_y + random.normal();
  });
}

TEST(FiguresOf, TellHowWideTheEdgesOfASinglePictureAre) {
  ExpectedPicture expected = {.part = Mask(100, 80), .tolerance_px = 15.0, .blur_px = 0.8};
  for (int y = 20; y < 60; ++y) {
    for (int x = 27; x < 67; ++x) {
      expected.part(x, y) = 1;
    }
  }
  for (const double sigma_px : {0.7, 1.5, 3.0, 5.0}) {
    const PictureFigures figures = figures_of(soft_square(sigma_px), expected, true);
    ASSERT_TRUE(figures.edge_px) << sigma_px;
    EXPECT_NEAR(*figures.edge_px, sigma_px, 0.1 + 0.1 * sigma_px);
    const PictureFigures anywhere = figures_of(soft_square(sigma_px), {}, true);
    ASSERT_TRUE(anywhere.edge_px) << sigma_px;
    EXPECT_NEAR(*anywhere.edge_px, sigma_px, 0.1 + 0.1 * sigma_px);
  }
  EXPECT_FALSE(figures_of(soft_square(0.7), expected).edge_px) << "nobody asked";
  const Frame even = frame_of(300, 240, [](int x, int) { return 100.0 + 0.2 * x; });
  EXPECT_FALSE(figures_of(even, {}, true).edge_px) << "no edges";
}

TEST(RejectionOf, NamesASinglePictureThatIsBlurred) {
  const PictureLimits limits;
  EXPECT_EQ(blur_limit_px(limits, 0.0), 0.0) << "nobody knows how sharp it can be";
  EXPECT_NEAR(blur_limit_px(limits, 0.8), 2.1, 1e-12);
  EXPECT_EQ(blur_limit_px({.max_blur_px = 3.0}, 0.8), 3.0);
  PictureFigures picture = {.mean = 0.3, .bright = 0.8, .sharpness = 0.1, .edge_px = 2.0};
  EXPECT_EQ(rejection_of(picture, limits, 0.0, 2.1), "");
  picture.edge_px = 2.2;
  EXPECT_THAT(rejection_of(picture, limits, 0.0, 2.1), HasSubstr("blurred: its edges"));
  EXPECT_EQ(rejection_of(picture, limits, 0.0), "");
  picture.edge_px.reset();
  EXPECT_EQ(rejection_of(picture, limits, 0.0, 2.1), "");
}

// The expected outline from a picture of a third of the size, 15 px from where the part is.
TEST(FiguresOf, SeeThePartThatIsAsFarOffAsItMayBe) {
  Mask expected(60, 40);
  for (int y = 10; y < 30; ++y) {
    for (int x = 20; x < 40; ++x) {
      expected(x, y) = 1;
    }
  }
  const Frame frame = frame_of(181, 121, [](int x, int y) {
    return x >= 75 && x < 135 && y >= 30 && y < 90 ? 120.0 : 20.0;
  });
  EXPECT_GT(figures_of(frame, {.part = expected, .tolerance_px = 18.0}).outline_share, 0.99);
  EXPECT_LT(figures_of(frame, {.part = expected}).outline_share, 0.7);
  const Frame none = frame_of(181, 121, [](int x, int) { return x < 100 ? 22.0 : 20.0; });
  EXPECT_LT(figures_of(none, {.part = expected, .tolerance_px = 18.0}).outline_share, 0.5);
}

}  // namespace
}  // namespace glint
