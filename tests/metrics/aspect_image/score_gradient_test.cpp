// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/aspect_image/score_gradient.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "metrics/aspect_image/homogeneity.h"
#include "metrics/aspect_image/noise_variance.h"
#include "tests/metrics/aspect_image/disc_view.h"

namespace glint {
namespace {

constexpr int kGradientSide = 48;
constexpr double kGradientFloor = 1e-3;

/// Two dents on an uneven ground, one bright and one dark.
struct TwoDents {
  ImageF aspect{kGradientSide, kGradientSide};
  Mask region{kGradientSide, kGradientSide, 1};
  std::vector<DefectPixels> defects;

  TwoDents() {
    const std::vector<DefectView> views = {
        disc_view("dent_1", 12.0, 12.0, 2.0, kGradientSide, kGradientSide),
        disc_view("dent_2", 35.0, 34.0, 2.0, kGradientSide, kGradientSide)};
    defects = defect_pixels(views, region);
    for (std::size_t i = 0; i < aspect.size(); ++i) {
      Rng rng(107, Stream::kTest, i);
      aspect.values()[i] = static_cast<float>(rng.uniform(0.3, 0.5));
      region.values()[i] = rng.uniform() < 0.8 ? 1 : 0;
    }
    for (const std::size_t pixel : defects[0].inside) {
      aspect.values()[pixel] += 0.3F;
    }
    for (const std::size_t pixel : defects[1].inside) {
      aspect.values()[pixel] -= 0.2F;
    }
  }

  double score(const std::string& name, const ImageF& image) const {
    const Homogeneity h = homogeneity(image, {}, 24, region);
    const std::vector<DefectScores> all = defect_scores(image, defects, kGradientFloor);
    const DefectSummary worst = summarise(all);
    return name == "homogeneity.h_rms"      ? h.h_rms
           : name == "homogeneity.h_abs"    ? h.h_abs
           : name == "homogeneity.mean"     ? h.mean
           : name == "defects.min_cnr"      ? worst.min_cnr
           : name == "defects.min_weber"    ? worst.min_weber
           : name == "defects.mean_weber"   ? worst.mean_weber
           : name == "defects.dent_1.cnr"   ? all[0].cnr
           : name == "defects.dent_2.cnr"   ? all[1].cnr
           : name == "defects.dent_1.weber" ? all[0].weber
                                            : all[1].weber;
  }
};

const std::vector<std::string>& derivative_names() {
  static const std::vector<std::string> names = {"homogeneity.h_rms",
                                                 "homogeneity.h_abs",
                                                 "homogeneity.mean",
                                                 "defects.min_cnr",
                                                 "defects.min_weber",
                                                 "defects.mean_weber",
                                                 "defects.dent_1.cnr",
                                                 "defects.dent_2.cnr",
                                                 "defects.dent_1.weber",
                                                 "defects.dent_2.weber"};
  return names;
}

// Every pixel is moved by 1e-3 up and down. Rounding the images to float leaves 1e-7 / 1e-3 of the
// derivative by a pixel, and the second order 1e-6.
TEST(GradientByAspect, AgreeWithDifferencesByEveryPixel) {
  const TwoDents scene;
  for (const std::string& name : derivative_names()) {
    const auto gradient =
        gradient_by_aspect(name, {scene.aspect, scene.region, scene.defects, kGradientFloor});
    ASSERT_TRUE(gradient) << name;
    double largest = 0.0;
    double worst = 0.0;
    for (std::size_t i = 0; i < scene.aspect.size(); ++i) {
      constexpr float kStep = 1e-3F;
      ImageF high = scene.aspect;
      ImageF low = scene.aspect;
      high.values()[i] += kStep;
      low.values()[i] -= kStep;
      const double width =
          static_cast<double>(high.values()[i]) - static_cast<double>(low.values()[i]);
      const double expected = (scene.score(name, high) - scene.score(name, low)) / width;
      largest = std::max(largest, std::abs(expected));
      // |f - mu| has a kink: pixels that the step takes across the mean are off by their own share.
      const bool crosses = name == "homogeneity.h_abs" &&
                           std::abs(static_cast<double>(scene.aspect.values()[i]) -
                                    scene.score("homogeneity.mean", scene.aspect)) < 2e-3;
      if (!crosses) {
        worst = std::max(worst, std::abs(static_cast<double>(gradient->values()[i]) - expected));
      }
    }
    EXPECT_GT(largest, 0.0) << name;
    EXPECT_LT(worst, 1e-3 * largest) << name;
  }
}

// Two pixels f = 0.4, 0.6: mu = 0.5, sigma = 0.1. d mean = 1/2 each. d h_rms by f_i =
// (sigma / mu^2 - (f_i - mu) / (sigma mu)) / 2 = (0.4 + 2) / 2 = 1.2 and (0.4 - 2) / 2 = -0.8.
TEST(GradientByAspect, MatchTwoHandWorkedPixels) {
  ImageF aspect(2, 1);
  aspect(0, 0) = 0.4F;
  aspect(1, 0) = 0.6F;
  const Mask region(2, 1, 1);
  const auto h = gradient_by_aspect("homogeneity.h_rms", {aspect, region, {}, 0.1}).value();
  EXPECT_NEAR(static_cast<double>(h(0, 0)), 1.2, 1e-5);
  EXPECT_NEAR(static_cast<double>(h(1, 0)), -0.8, 1e-5);
  const auto mean = gradient_by_aspect("homogeneity.mean", {aspect, region, {}, 0.1}).value();
  EXPECT_FLOAT_EQ(mean(0, 0), 0.5F);
}

// Scatter of 0.24 makes sqrt(0.01 + 0.0576) = 0.26 of the deviation: d h_rms by f_i =
// (0.26 / mu^2 - (f_i - mu) / (0.26 mu)) / 2 = (1.04 + 0.76923) / 2 and (1.04 - 0.76923) / 2.
TEST(GradientByAspect, NoiseIsPartOfTheDeviation) {
  ImageF aspect(2, 1);
  aspect(0, 0) = 0.4F;
  aspect(1, 0) = 0.6F;
  const Mask region(2, 1, 1);
  const ImageF deviation(2, 1, 0.24F);
  const ScoredImage image = {aspect, region, {}, 0.1, &deviation};
  const auto h = gradient_by_aspect("homogeneity.h_rms", image).value();
  EXPECT_NEAR(static_cast<double>(h(0, 0)), 0.904615, 1e-5);
  EXPECT_NEAR(static_cast<double>(h(1, 0)), 0.135385, 1e-5);
  EXPECT_NEAR(noise_share(image), 0.0576 / 0.0676, 1e-6);
  EXPECT_EQ(noise_share({aspect, region, {}, 0.1}), 0.0);
}

// Some pixels scatter more than they stand out, some less, some not at all.
TEST(GradientByAspect, AgreeWithDifferencesUnderNoise) {
  const TwoDents scene;
  ImageF deviation(kGradientSide, kGradientSide);
  for (std::size_t i = 0; i < deviation.size(); ++i) {
    Rng rng(108, Stream::kTest, i);
    deviation.values()[i] = i % 3 == 0 ? 0.0F : static_cast<float>(rng.uniform(0.01, 0.15));
  }
  const auto score = [&](const std::string& name, const ImageF& aspect) {
    const Homogeneity h = with_noise_variance(
        homogeneity(aspect, {}, 24, scene.region), aspect, deviation, scene.region);
    return name == "homogeneity.h_rms" ? h.h_rms : h.h_abs;
  };
  for (const std::string name : {"homogeneity.h_rms", "homogeneity.h_abs"}) {
    const ScoredImage image = {
        scene.aspect, scene.region, scene.defects, kGradientFloor, &deviation};
    const ImageF gradient = gradient_by_aspect(name, image).value();
    // All pixels at once, each by its own share of a step: scores in float leave 1e-6 of it.
    ImageF high = scene.aspect;
    ImageF low = scene.aspect;
    double expected = 0.0;
    for (std::size_t i = 0; i < high.size(); ++i) {
      Rng rng(109, Stream::kTest, i);
      const bool scatters = deviation.values()[i] > 0.0F;  // the others have a kink at the mean
      const float step = scatters || name.ends_with("rms")
                             ? static_cast<float>(rng.uniform(0.0, 2e-3)) *
                                   (scene.aspect.values()[i] > 0.4F ? 1.0F : -1.0F)
                             : 0.0F;
      high.values()[i] += step;
      low.values()[i] -= step;
      expected += static_cast<double>(gradient.values()[i]) *
                  (static_cast<double>(high.values()[i]) - static_cast<double>(low.values()[i]));
    }
    EXPECT_GT(std::abs(expected), 1e-3) << name;
    EXPECT_NEAR(score(name, high) - score(name, low), expected, 2e-3 * std::abs(expected)) << name;
  }
}

// Pixels of a dent weigh the same. In float each would err by the same; together they do not.
TEST(GradientByAspect, RoundingOfManyEqualPixelsDoesNotAddUp) {
  constexpr int kSide = 64;
  ImageF aspect(kSide, kSide, 0.4F);
  const Mask region(kSide, kSide, 1);
  const std::vector<DefectView> views = {disc_view("dent", 32.0, 32.0, 6.0, kSide, kSide)};
  const std::vector<DefectPixels> defects = defect_pixels(views, region);
  for (const std::size_t pixel : defects[0].inside) {
    aspect.values()[pixel] = 0.5F;
  }
  const ImageF gradient =
      gradient_by_aspect("defects.dent.cnr", {aspect, region, defects, 1e-3}).value();
  double sum = 0.0;
  for (const std::size_t pixel : defects[0].inside) {
    sum += static_cast<double>(gradient.values()[pixel]);
  }
  EXPECT_NEAR(sum, 1e3, 1e3 * 1e-9);
  for (const std::size_t pixel : defects[0].ring) {
    sum += static_cast<double>(gradient.values()[pixel]);
  }
  EXPECT_NEAR(sum, 0.0, 1e3 * 1e-9);
}

// Two pixels that differ by the last digit of a float are even; 1e-4 apart they are not.
TEST(GradientByAspect, RoundingIsNoUnevenness) {
  ImageF aspect(2, 1);
  aspect(0, 0) = 0.5F;
  const Mask region(2, 1, 1);
  for (const char* score : {"homogeneity.h_rms", "homogeneity.h_abs"}) {
    aspect(1, 0) = std::nextafter(0.5F, 1.0F);
    const auto even = gradient_by_aspect(score, {aspect, region, {}, 0.1}).value();
    EXPECT_EQ(even(0, 0), 0.0F) << score;
    EXPECT_EQ(even(1, 0), 0.0F) << score;
    aspect(1, 0) = 0.5001F;
    EXPECT_GT(gradient_by_aspect(score, {aspect, region, {}, 0.1}).value()(0, 0), 0.5F) << score;
  }
  aspect(1, 0) = std::nextafter(0.5F, 1.0F);
  EXPECT_EQ(gradient_by_aspect("homogeneity.mean", {aspect, region, {}, 0.1}).value()(0, 0), 0.5F);
}

// Sums are taken beside the region's first value: here it is dark, and the others differ by 1e-5.
TEST(GradientByAspect, AFarFirstPixelCostsNoDigits) {
  constexpr int kWidth = 331;
  constexpr int kHeight = 40;
  ImageF aspect(kWidth, kHeight);
  double mean = 0.0;
  for (std::size_t i = 1; i < aspect.size(); ++i) {
    Rng rng(110, Stream::kTest, i);
    aspect.values()[i] = static_cast<float>(rng.uniform(0.5, 0.50001));
    mean += static_cast<double>(aspect.values()[i]) / static_cast<double>(aspect.size());
  }
  double variance = 0.0;
  double size = 0.0;
  double sign = 0.0;
  const auto count = static_cast<double>(aspect.size());
  for (const float value : aspect.values()) {
    const double rest = static_cast<double>(value) - mean;
    variance += rest * rest / count;
    size += std::abs(rest) / count;
    sign += (rest > 0.0 ? 1.0 : -1.0) / count;
  }
  const double sigma = std::sqrt(variance);
  // Derivatives are in float, and those of h_abs may cancel.
  const auto tolerance = [&](double derivative) {
    return 1e-7 * std::abs(derivative) + 1e-8 / count;
  };
  const Mask region(kWidth, kHeight, 1);
  const auto rms = gradient_by_aspect("homogeneity.h_rms", {aspect, region, {}, 0.1}).value();
  const auto abs = gradient_by_aspect("homogeneity.h_abs", {aspect, region, {}, 0.1}).value();
  for (std::size_t i = 0; i < aspect.size(); ++i) {
    const double rest = static_cast<double>(aspect.values()[i]) - mean;
    const double by_rms = (sigma / (mean * mean) - rest / (sigma * mean)) / count;
    const double by_abs =
        (size / (mean * mean) + (sign - (rest > 0.0 ? 1.0 : -1.0)) / mean) / count;
    ASSERT_NEAR(static_cast<double>(rms.values()[i]), by_rms, tolerance(by_rms)) << i;
    ASSERT_NEAR(static_cast<double>(abs.values()[i]), by_abs, tolerance(by_abs)) << i;
  }
}

TEST(GradientByAspect, ADefectThatIsNotSeenHasNoGradient) {
  TwoDents scene;
  std::ranges::fill(scene.aspect.values(), 0.4F);
  scene.aspect.values()[scene.defects[0].inside[0]] = std::nextafter(0.4F, 1.0F);
  const auto gradient = gradient_by_aspect(
      "defects.dent_1.cnr", {scene.aspect, scene.region, scene.defects, kGradientFloor});
  EXPECT_EQ(*std::ranges::max_element(gradient->values()), 0.0F);
  EXPECT_EQ(*std::ranges::min_element(gradient->values()), 0.0F);
}

TEST(GradientByAspect, TheSmallestIsThatOfTheDefectAtFault) {
  const TwoDents scene;
  const ScoredImage image = {scene.aspect, scene.region, scene.defects, kGradientFloor};
  const std::string worst = scene.score("defects.dent_1.cnr", scene.aspect) <
                                    scene.score("defects.dent_2.cnr", scene.aspect)
                                ? "defects.dent_1.cnr"
                                : "defects.dent_2.cnr";
  EXPECT_EQ(gradient_by_aspect("defects.min_cnr", image)->values(),
            gradient_by_aspect(worst, image)->values());
}

TEST(GradientByAspect, StepsAndPercentilesHaveNone) {
  const TwoDents scene;
  const ScoredImage image = {scene.aspect, scene.region, scene.defects, kGradientFloor};
  for (const char* name : {"homogeneity.robust",
                           "homogeneity.clipped_share",
                           "defects.min_dprime",
                           "view.hidden_share"}) {
    EXPECT_FALSE(gradient_by_aspect(name, image)) << name;
    EXPECT_FALSE(has_gradient(name)) << name;
  }
  EXPECT_FALSE(gradient_by_aspect("defects.min_cnr", {scene.aspect, scene.region, {}, 0.1}));
}

}  // namespace
}  // namespace glint
