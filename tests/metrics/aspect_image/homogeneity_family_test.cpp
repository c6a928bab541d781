// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/aspect_image/homogeneity_family.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/rng.h"
#include "metrics/aspect_image/homogeneity.h"

namespace glint {
namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;

template <class Value>
ImageF painted(int width, int height, const Value& value) {
  ImageF image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image(x, y) = static_cast<float>(value(x, y));
    }
  }
  return image;
}

Mask whole(const ImageF& image) {
  return {image.width(), image.height(), 1};
}

double sign_of_square(int x, int y) {
  return (x + y) % 2 == 0 ? 1.0 : -1.0;
}

TEST(ShadingOf, AnEvenPictureIsThatPictureInAnyRegion) {
  Rng rng(1, Stream::kTest, 0);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const ImageF even(60, 40, 0.37f);
    Mask region(60, 40);
    for (auto& pixel : region.values()) {
      pixel = rng.uniform() < 0.3 ? 1 : 0;
    }
    region(30, 20) = 1;
    const ImageF shading = shading_of(even, region, rng.uniform(0.3, 30.0));
    for (std::size_t i = 0; i < region.size(); ++i) {
      EXPECT_NEAR(shading.values()[i], region.values()[i] != 0 ? 0.37f : 0.0f, 1e-6f);
    }
  }
}

// Four running means add up to the variance that was asked for, exactly.
TEST(ShadingOf, ASinglePixelHasTheVarianceOfTheGaussian) {
  for (const double sigma_px : {0.8, 2.0, 3.3, 7.9}) {
    ImageF spot(161, 161);
    spot(80, 80) = 1.0f;
    const ImageF shading = shading_of(spot, whole(spot), sigma_px);
    double sum = 0.0;
    double along = 0.0;
    double across = 0.0;
    for (int y = 0; y < 161; ++y) {
      for (int x = 0; x < 161; ++x) {
        const auto value = static_cast<double>(shading(x, y));
        sum += value;
        along += value * (x - 80) * (x - 80);
        across += value * (y - 80) * (y - 80);
      }
    }
    EXPECT_NEAR(sum, 1.0, 1e-5);
    EXPECT_NEAR(along / sum, sigma_px * sigma_px, 1e-4 * sigma_px * sigma_px);
    EXPECT_NEAR(across / sum, sigma_px * sigma_px, 1e-4 * sigma_px * sigma_px);
  }
}

TEST(ShadingOf, TheRegionDoesNotSeeWhatLiesBesideIt) {
  ImageF image = painted(50, 50, [](int x, int) { return 0.3 + 0.004 * x; });
  Mask region(50, 50);
  for (int y = 10; y < 40; ++y) {
    for (int x = 10; x < 30; ++x) {
      region(x, y) = 1;
    }
  }
  const ImageF before = shading_of(image, region, 6.0);
  image(5, 5) = 100.0f;
  image(35, 20) = 100.0f;
  EXPECT_EQ(shading_of(image, region, 6.0).values(), before.values());
}

// A chessboard of 0.5 -+ 0.05 has no shading: 1 - 0.05 / 0.5 = 0.9. On a slow wave of -+ 40 % it
// still has; h_rms is 1 - sqrt((1 + 0.08) (1 + 0.01) - 1) = 0.70.
TEST(HomogeneityFamily, ResidualSeesTheTextureAndNotTheShading) {
  const auto texture = [](int x, int y) { return 1.0 + 0.1 * sign_of_square(x, y); };
  const auto wave = [](int x) { return 1.0 + 0.4 * std::sin(kFullTurn * x / 400.0); };
  const ImageF flat = painted(400, 60, [&](int x, int y) { return 0.5 * texture(x, y); });
  const ImageF shaded =
      painted(400, 60, [&](int x, int y) { return 0.5 * wave(x) * texture(x, y); });
  const ImageF smooth = painted(400, 60, [&](int x, int) { return 0.5 * wave(x); });
  const FamilyScales scales = {.defect_diameter_px = 5.0};
  EXPECT_NEAR(homogeneity_family(flat, whole(flat), scales).residual, 0.9, 2e-4);
  EXPECT_NEAR(homogeneity_family(shaded, whole(shaded), scales).residual, 0.9, 0.005);
  EXPECT_NEAR(homogeneity(shaded, {}, 0, whole(shaded)).h_rms, 0.70, 0.005);
  EXPECT_GT(homogeneity_family(smooth, whole(smooth), scales).residual, 0.97);
  EXPECT_LT(homogeneity(smooth, {}, 0, whole(smooth)).h_rms, 0.73);
}

// The cut is at 1 / (4 diameters), where the Gaussian's response is one half.
TEST(HomogeneityFamily, SharesAreHalvesAtTheCut) {
  const FamilyScales scales = {.defect_diameter_px = 5.0};  // cut at a wavelength of 20 px
  const auto low_share = [&](double wavelength_px) {
    const ImageF wave = painted(
        1600, 8, [&](int x, int) { return 0.5 + 0.1 * std::sin(kFullTurn * x / wavelength_px); });
    return homogeneity_family(wave, whole(wave), scales).low_share;
  };
  EXPECT_NEAR(low_share(20.0), 0.5, 0.01);
  EXPECT_GT(low_share(100.0), 0.95);  // 2^(-1/25) = 0.973
  // A Gaussian has 2^(-4); running means of 6.5 px have (sin(0.65 pi) / (0.65 pi))^4 = 0.036.
  EXPECT_NEAR(low_share(10.0), 0.036, 0.01);
}

TEST(HomogeneityFamily, SharesAddUpToOne) {
  Rng rng(2, Stream::kTest, 0);
  for (int repeat = 0; repeat < 1000; ++repeat) {
    const ImageF image = painted(24, 17, [&](int, int) { return rng.uniform(); });
    const HomogeneityFamily family =
        homogeneity_family(image, whole(image), {.defect_diameter_px = rng.uniform(0.5, 10.0)});
    EXPECT_GE(family.low_share, 0.0);
    EXPECT_GE(family.high_share, 0.0);
    EXPECT_DOUBLE_EQ(family.low_share + family.high_share, 1.0);
    EXPECT_LE(family.residual, 1.0);
    EXPECT_LE(family.worst_region, 1.0);
  }
}

TEST(HomogeneityFamily, OfAnEvenPictureIsPerfectAndOfABlackOneWorthless) {
  const ImageF even(64, 64, 0.4f);
  const HomogeneityFamily best = homogeneity_family(even, whole(even), {.period_px = 8.0});
  EXPECT_NEAR(best.u0, 1.0, 1e-6);
  EXPECT_NEAR(best.residual, 1.0, 1e-6);
  EXPECT_NEAR(best.worst_region, 1.0, 1e-6);
  EXPECT_EQ(best.high_share, 0.0);
  ASSERT_TRUE(best.ripple);
  EXPECT_NEAR(*best.ripple, 0.0, 1e-6);
  const ImageF black(64, 64);
  const HomogeneityFamily worst = homogeneity_family(black, whole(black), {.period_px = 8.0});
  EXPECT_EQ(worst.u0, 0.0);
  EXPECT_EQ(worst.residual, -64.0);
  EXPECT_EQ(worst.worst_region, -16.0);  // a tile of 16 x 16
  EXPECT_FALSE(worst.ripple);
}

// One of 4 x 4 tiles holds 0.4 and 0.6 in halves: mean 0.5, deviation 0.1, h_rms 0.8. In the whole
// it is one sixteenth: 1 - 0.1 / 4 / 0.5 = 0.95.
TEST(WorstRegion, IsThatOfTheUnevenTile) {
  const auto value = [](int x, int y) {
    const bool is_there = x >= 10 && x < 20 && y >= 20 && y < 30;
    return is_there ? (x < 15 ? 0.4 : 0.6) : 0.5;
  };
  const ImageF image = painted(40, 40, value);
  EXPECT_NEAR(worst_region(image, whole(image), 4), 0.8, 1e-5);
  EXPECT_NEAR(worst_region(image, whole(image), 1), 0.95, 1e-5);
}

TEST(WorstRegion, LeavesTilesOutThatTheRegionHardlyTouches) {
  ImageF image(40, 40, 0.5f);
  image(0, 0) = 0.1f;
  Mask region(40, 40, 1);
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 10; ++x) {
      region(x, y) = y < 2 ? 1 : 0;  // a fifth of the first tile
    }
  }
  EXPECT_NEAR(worst_region(image, region, 4), 1.0, 1e-6);
  for (int x = 0; x < 10; ++x) {
    region(x, 2) = 1;  // three tenths
  }
  EXPECT_LT(worst_region(image, region, 4), 0.9);
}

TEST(FringeRipple, IsTheAmplitudeOverTheMean) {
  const auto wave = [](int x, double period_px) { return std::cos(kFullTurn * x / period_px); };
  const ImageF one = painted(512, 4, [&](int x, int) { return 0.5 + 0.1 * wave(x, 16.0); });
  EXPECT_NEAR(*fringe_ripple(one, whole(one), 16.0), 0.2, 1e-4);
  // Two harmonics: sqrt(0.1^2 + 0.05^2) / 0.5.
  const ImageF two =
      painted(512, 4, [&](int x, int) { return 0.5 + 0.1 * wave(x, 16.0) + 0.05 * wave(x, 8.0); });
  EXPECT_NEAR(*fringe_ripple(two, whole(two), 16.0), 0.223607, 1e-4);
  // A period that is no whole number, in runs that hold no whole number of them.
  const ImageF odd = painted(301, 4, [&](int x, int) { return 0.5 + 0.1 * wave(x, 13.7); });
  EXPECT_NEAR(*fringe_ripple(odd, whole(odd), 13.7), 0.2, 0.002);
}

TEST(FringeRipple, IsNotTakenInByShadingOrNoiseOrOtherStripes) {
  const ImageF shaded = painted(500, 4, [](int x, int) { return 0.2 + 0.001 * x; });
  EXPECT_LT(*fringe_ripple(shaded, whole(shaded), 16.0), 0.005);
  Rng rng(3, Stream::kTest, 0);
  const ImageF noisy = painted(500, 50, [&](int, int) { return 0.5 + 0.05 * rng.normal(); });
  EXPECT_LT(*fringe_ripple(noisy, whole(noisy), 16.0), 0.005);  // against 0.1 of the pixels
  const ImageF other =
      painted(512, 4, [](int x, int) { return 0.5 + 0.1 * std::cos(kFullTurn * x / 100.0); });
  EXPECT_LT(*fringe_ripple(other, whole(other), 16.0), 0.005);
}

/// Mean of `frames` pictures of stripes that move on by a part of their period of 16 px each.
ImageF scanned_stripes(int frames, double duty) {
  return painted(512, 4, [&](int x, int) {
    double sum = 0.0;
    for (int frame = 0; frame < frames; ++frame) {
      const double phase = (x + 0.013) / 16.0 + static_cast<double>(frame) / frames;
      sum += phase - std::floor(phase) < duty ? 1.0 : 0.0;
    }
    return sum / frames;
  });
}

// Stripes of duty d in N frames cancel where N d is a whole number: 5 x 0.4 = 2, 5 x 0.5 = 2.5.
// Otherwise the mean over the scan is 2/5 or 3/5, in stripes five times as fine.
TEST(FringeRipple, RevealsADutyThatTheFramesDoNotCancel) {
  EXPECT_LT(*fringe_ripple(scanned_stripes(5, 0.4), Mask(512, 4, 1), 16.0), 0.001);
  EXPECT_GT(*fringe_ripple(scanned_stripes(5, 0.5), Mask(512, 4, 1), 16.0), 0.1);
}

TEST(FringeRipple, NeedsARunOfFourPeriods) {
  const ImageF image(63, 4, 0.5f);
  EXPECT_FALSE(fringe_ripple(image, whole(image), 16.0));
  EXPECT_TRUE(fringe_ripple(image, whole(image), 15.0));
}

}  // namespace
}  // namespace glint
