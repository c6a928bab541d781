// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/aspect_image/homogeneity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/rng.h"
#include "metrics/aspect_image/defect_scores.h"
#include "tests/metrics/aspect_image/disc_view.h"

namespace glint {
namespace {

Homogeneity scored(const ImageF& aspect) {
  return homogeneity(aspect, {}, 0, Mask(aspect.width(), aspect.height(), 1));
}

ImageF one_row(const std::vector<float>& values) {
  ImageF image(static_cast<int>(values.size()), 1);
  std::ranges::copy(values, image.row(0));
  return image;
}

ImageF random_aspect(Rng& rng) {
  ImageF image(1 + static_cast<int>(rng.next_u32() % 40), 1 + static_cast<int>(rng.next_u32() % 9));
  const double power = rng.uniform(0.1, 6.0);
  for (float& value : image.values()) {
    value = static_cast<float>(std::pow(rng.uniform(), power));
  }
  return image;
}

// Mean 0.25; squared deviations (0.0225 + 0.0025 + 0.0025 + 0.0225) / 4 = 0.0125, root 0.111803,
// over the mean 0.447214; mean absolute deviation 0.4 / 4 = 0.1, over the mean 0.4.
TEST(Homogeneity, MatchesAHandWorkedExample) {
  const Homogeneity result = scored(one_row({0.1f, 0.2f, 0.3f, 0.4f}));
  EXPECT_NEAR(result.mean, 0.25, 1e-7);
  EXPECT_NEAR(result.h_rms, 0.552786, 1e-6);
  EXPECT_NEAR(result.h_abs, 0.6, 1e-6);
}

// 0.05, 0.10, ... 1.00: the first of twenty is P5 = 0.05, the nineteenth P95 = 0.95; 1 - 0.9 / 1.
TEST(Homogeneity, TakesPercentilesByNearestRank) {
  std::vector<float> values;
  for (int i = 20; i >= 1; --i) {
    values.push_back(0.05f * static_cast<float>(i));
  }
  EXPECT_NEAR(scored(one_row(values)).robust.value(), 0.1, 1e-6);
}

TEST(Homogeneity, TakesThePercentilesThatSortingGives) {
  Rng rng(2, Stream::kTest, 0);
  for (int trial = 0; trial < 1000; ++trial) {
    const ImageF image = random_aspect(rng);
    ImageF::Values sorted = image.values();
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double share) {
      const auto rank = std::ceil(share * static_cast<double>(sorted.size()));
      return static_cast<double>(sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1]);
    };
    const double expected = 1.0 - (at(0.95) - at(0.05)) / (at(0.95) + at(0.05));
    EXPECT_EQ(scored(image).robust, expected) << trial;
  }
}

// Larger pictures with ties, spikes and ramps: the bracket from a sample must never decide wrongly.
TEST(Homogeneity, TakesThePercentilesThatSortingGivesOfLargePictures) {
  Rng rng(19, Stream::kTest, 0);
  for (int trial = 0; trial < 60; ++trial) {
    ImageF image(301, 97);
    const int kind = trial % 4;
    for (std::size_t i = 0; i < image.size(); ++i) {
      const double u = rng.uniform();
      const double ramp = static_cast<double>(i) / static_cast<double>(image.size());
      const double value = kind == 0   ? u
                           : kind == 1 ? std::floor(4.0 * u) / 4.0
                           : kind == 2 ? ramp
                                       : (u < 0.06 ? 0.01 * u : 0.5 + 1e-7 * u);
      image.values()[i] = static_cast<float>(value);
    }
    Mask region(image.width(), image.height());
    std::vector<float> sorted;
    for (std::size_t i = 0; i < image.size(); ++i) {
      region.values()[i] = rng.uniform() < 0.9 ? 1 : 0;
      if (region.values()[i] != 0) {
        sorted.push_back(image.values()[i]);
      }
    }
    std::sort(sorted.begin(), sorted.end());
    const auto ranked = [&](double share) {
      const double rank = std::ceil(share * static_cast<double>(sorted.size()));
      return static_cast<double>(sorted[static_cast<std::size_t>(rank) - 1]);
    };
    const double expected = 1.0 - (ranked(0.95) - ranked(0.05)) / (ranked(0.95) + ranked(0.05));
    EXPECT_EQ(homogeneity(image, {}, 0, region).robust, expected) << trial;
  }
}

TEST(Homogeneity, NeverHasTheAbsoluteFormBelowTheSquaredOne) {
  Rng rng(3, Stream::kTest, 0);
  int apart = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Homogeneity result = scored(random_aspect(rng));
    EXPECT_GE(result.h_abs, result.h_rms - 1e-12);
    EXPECT_LE(result.h_abs, 1.0);
    apart += result.h_abs > result.h_rms + 0.01 ? 1 : 0;
  }
  EXPECT_GT(apart, 800);
}

TEST(Homogeneity, DoesNotDependOnExposure) {
  Rng rng(4, Stream::kTest, 0);
  for (int trial = 0; trial < 1000; ++trial) {
    const ImageF image = random_aspect(rng);
    ImageF darker = image;
    for (float& value : darker.values()) {
      value *= 0.25f;
    }
    EXPECT_NEAR(scored(image).h_rms, scored(darker).h_rms, 1e-9);
    EXPECT_NEAR(scored(image).h_abs, scored(darker).h_abs, 1e-9);
  }
}

// Mean |z| of a standard normal is sqrt(2 / pi) = 0.797885, of a uniform spread sqrt(3) / 2.
TEST(Homogeneity, RelatesItsTwoFormsOnAGaussianSpread) {
  Rng rng(5, Stream::kTest, 0);
  ImageF gaussian(500, 200);
  ImageF uniform(500, 200);
  for (std::size_t i = 0; i < gaussian.size(); ++i) {
    gaussian.values()[i] = static_cast<float>(0.5 + 0.05 * rng.normal());
    uniform.values()[i] = static_cast<float>(rng.uniform(0.4, 0.6));
  }
  const auto ratio = [](const Homogeneity& h) { return (1.0 - h.h_abs) / (1.0 - h.h_rms); };
  EXPECT_NEAR(ratio(scored(gaussian)), 0.797885, 0.006);  // 4.5 x 0.6028 x sqrt(0.57 / n) = 0.006
  EXPECT_NEAR(ratio(scored(uniform)), 0.866025, 0.006);
}

TEST(Homogeneity, LooksAtTheRegionOnly) {
  ImageF aspect = one_row({0.0f, 0.5f, 0.5f, 1.0f});
  Mask region(4, 1);
  region.values() = {0, 1, 1, 0};
  EXPECT_EQ(homogeneity(aspect, {}, 0, region).h_rms, 1.0);
  EXPECT_LT(scored(aspect).h_rms, 0.5);
}

TEST(Homogeneity, IsNotClampedBelowZero) {
  // One lit pixel of 101: the worst image, 1 - sqrt(100) = -9 and 2 / 101 - 1 = -0.980198.
  std::vector<float> values(101, 0.0f);
  values[7] = 0.6f;
  EXPECT_NEAR(scored(one_row(values)).h_rms, -9.0, 1e-9);
  EXPECT_NEAR(scored(one_row(values)).h_abs, -0.980198, 1e-6);
}

TEST(Homogeneity, LetsABlackRegionWinAgainstNothing) {
  std::vector<float> values(101, 0.0f);
  const Homogeneity black = scored(one_row(values));
  values[7] = 0.6f;
  const Homogeneity worst = scored(one_row(values));
  EXPECT_LT(black.h_rms, worst.h_rms);
  EXPECT_LT(black.h_abs, worst.h_abs);
  EXPECT_EQ(black.robust, 0.0);
  EXPECT_EQ(black.lit_share, 0.0);
}

TEST(Homogeneity, CountsPixelsThatAreClippedInEveryFrameAndThoseThatAreLit) {
  Image<std::uint16_t> clipped(4, 1);
  clipped.values() = {24, 23, 24, 0};
  const ImageF aspect = one_row({1.0f, 0.99f, 1.0f, 0.005f});
  Mask region(4, 1, 1);
  const Homogeneity all = homogeneity(aspect, clipped, 24, region);
  EXPECT_EQ(all.clipped_share, 0.5);
  EXPECT_EQ(all.lit_share, 0.75);
  region(0, 0) = 0;
  EXPECT_NEAR(homogeneity(aspect, clipped, 24, region).clipped_share, 1.0 / 3.0, 1e-12);
  EXPECT_EQ(scored(aspect).clipped_share, 0.5);  // without counts: aspect at full scale
}

TEST(Homogeneity, AnAllWhiteImageIsEvenAndCaught) {
  const ImageF white(41, 41, 1.0f);
  const Homogeneity result = scored(white);
  EXPECT_EQ(result.h_rms, 1.0);
  EXPECT_EQ(result.clipped_share, 1.0);
  const std::vector<DefectView> dents = {disc_view("dent", 20.0, 20.0, 2.0, 41, 41)};
  const auto pixels = defect_pixels(dents, Mask(41, 41, 1));
  const auto scores = defect_scores(white, pixels, 1e-3);
  EXPECT_EQ(scores[0].cnr, 0.0);
  EXPECT_EQ(scores[0].weber, 0.0);
  EXPECT_EQ(scores[0].dprime, 0.0);
  EXPECT_EQ(scores[0].signature, 0.0);
}

// 5 x 5 at 0.9 with one 0: the nine squares around it average 8 x 0.9 / 9 = 0.8; the whole
// 24 x 0.9 / 25 = 0.864; 0.8 / 0.864 = 0.925926.
TEST(SmallestOverMean, SmoothsOverNinePixels) {
  ImageF aspect(5, 5, 0.9f);
  aspect(2, 2) = 0.0f;
  EXPECT_NEAR(smallest_over_mean(aspect, Mask(5, 5, 1)), 0.925926, 1e-6);
  EXPECT_EQ(smallest_over_mean(ImageF(5, 5), Mask(5, 5, 1)), 0.0);
}

}  // namespace
}  // namespace glint
