// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scores of a dearer picture from random squares of it.
#include "studies/accuracy/sampled_error.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint::sampled_error_test {
namespace {

const std::vector<std::string> kScores = {
    "homogeneity.h_rms", "homogeneity.h_abs", "homogeneity.mean"};

/// By the table of docs/theory/homogeneity.md.
Scores scores_of_values(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values) {
    mean += value / count;
  }
  double squares = 0.0;
  double sizes = 0.0;
  for (const double value : values) {
    squares += (value - mean) * (value - mean) / count;
    sizes += std::abs(value - mean) / count;
  }
  return {{"homogeneity.h_rms", 1.0 - std::sqrt(squares) / mean},
          {"homogeneity.h_abs", 1.0 - sizes / mean},
          {"homogeneity.mean", mean}};
}

/// A picture of squares by two ways to render.
struct MadePictures {
  std::vector<SampledSquare> squares;

  Scores scores(double GreyPair::*which) const {
    std::vector<double> values;
    for (const SampledSquare& square : squares) {
      for (const GreyPair& pair : square) {
        values.push_back(pair.*which);
      }
    }
    return scores_of_values(values);
  }

  double difference(const std::string& score) const {
    return scores(&GreyPair::dearer).at(score) - scores(&GreyPair::cheap).at(score);
  }
};

/// The dearer one is brighter by a twentieth and has other noise.
MadePictures made_pictures(std::size_t num_squares, std::size_t pixels) {
  Rng rng(1, Stream::kTest, 0);
  MadePictures made;
  for (std::size_t i = 0; i < num_squares; ++i) {
    SampledSquare square;
    for (std::size_t k = 0; k < pixels; ++k) {
      const double cheap = 0.5 + 0.1 * rng.normal();
      square.push_back({.cheap = cheap, .dearer = 1.05 * cheap + 0.03 * rng.normal()});
    }
    made.squares.push_back(square);
  }
  return made;
}

TEST(SampledError, OfAllSquaresItIsTheDifferenceOfThePictures) {
  const MadePictures made = made_pictures(16, 5);
  const Scores cheap = made.scores(&GreyPair::cheap);
  for (const std::string& score : kScores) {
    const auto found = sampled_error(score, cheap, made.squares);
    ASSERT_TRUE(found) << score;
    EXPECT_NEAR(found->difference, made.difference(score), 1e-12) << score;
    EXPECT_GT(found->error, 0.0) << score;
    EXPECT_NEAR(found->off, 0.0, 1e-12) << score;
    EXPECT_GT(found->off_error, 0.0) << score;
  }
}

// Half of the pixels 0.4, half 0.6: mean 0.5, both deviations 0.1. A pixel of 8 that is brighter by
// e than 0.6 changes h_rms by e (0.1 / 0.5^2 - (0.6 - 0.5) / (0.1 0.5)) / 8 = -0.2 e, and h_abs by
// e (0.1 / 0.5^2 - 1 / 0.5) / 8, the same.
TEST(SampledError, APixelCountsByTheDerivativeOfTheScore) {
  constexpr double kChange = 1e-4;
  std::vector<SampledSquare> squares(
      4, {{.cheap = 0.4, .dearer = 0.4}, {.cheap = 0.6, .dearer = 0.6}});
  const Scores cheap = {
      {"homogeneity.h_rms", 0.8}, {"homogeneity.h_abs", 0.8}, {"homogeneity.mean", 0.5}};
  for (const std::string& score : kScores) {
    const auto found = sampled_error(score, cheap, squares);
    ASSERT_TRUE(found) << score;
    EXPECT_NEAR(found->difference, 0.0, 1e-12) << score;
    EXPECT_NEAR(found->error, 0.0, 1e-12) << score;
  }
  squares.back().back().dearer += kChange;
  EXPECT_NEAR(sampled_error("homogeneity.h_rms", cheap, squares)->difference, -0.2 * kChange, 5e-8);
  EXPECT_NEAR(sampled_error("homogeneity.h_abs", cheap, squares)->difference, -0.2 * kChange, 5e-8);
  // Of a mean the jackknife is s / sqrt(n): squares' means differ by 0, 0, 0 and 5e-5.
  const auto mean = sampled_error("homogeneity.mean", cheap, squares);
  EXPECT_NEAR(mean->difference, kChange / 8.0, 1e-12);
  EXPECT_NEAR(mean->error, kChange / 8.0, 1e-12);
}

// 400 times 16 of 64 squares: the mean is that of the pictures, and the scatter the stated one.
TEST(SampledError, HasNoBiasAndKnowsItsScatter) {
  constexpr int kDraws = 400;
  constexpr int kDrawn = 16;
  const MadePictures made = made_pictures(64, 4);
  const Scores cheap = made.scores(&GreyPair::cheap);
  Rng rng(2, Stream::kTest, 0);
  std::map<std::string, std::vector<double>> differences;
  std::map<std::string, double> errors;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<SampledSquare> drawn;
    for (int i = 0; i < kDrawn; ++i) {
      drawn.push_back(made.squares[rng.next_u32() % made.squares.size()]);
    }
    for (const std::string& score : kScores) {
      const auto found = sampled_error(score, cheap, drawn);
      differences[score].push_back(found->difference);
      errors[score] += found->error / kDraws;
    }
  }
  for (const std::string& score : kScores) {
    double mean = 0.0;
    for (const double value : differences[score]) {
      mean += value / kDraws;
    }
    double variance = 0.0;
    for (const double value : differences[score]) {
      variance += (value - mean) * (value - mean) / (kDraws - 1.0);
    }
    const double spread = std::sqrt(variance);
    EXPECT_NEAR(mean, made.difference(score), 0.25 * spread) << score;
    EXPECT_NEAR(errors[score] / spread, 1.0, 0.25) << score;
  }
}

TEST(SampledError, IsNoneWhereAScoreDoesNotFollowFromItsPixels) {
  for (const std::string& score : kScores) {
    EXPECT_TRUE(follows_from_squares(score)) << score;
  }
  for (const char* score : {"homogeneity.robust",
                            "homogeneity.clipped_share",
                            "homogeneity.h_rms.error",
                            "homogeneity.h_rms.low",
                            "defects.min_cnr"}) {
    EXPECT_FALSE(follows_from_squares(score)) << score;
  }
  const std::vector<SampledSquare> dark(
      2, {{.cheap = 0.4, .dearer = 0.0}, {.cheap = 0.6, .dearer = 0.0}});
  const Scores known = {{"homogeneity.h_rms", 0.8}, {"homogeneity.mean", 0.5}};
  EXPECT_FALSE(sampled_error("homogeneity.h_rms", known, dark)) << "the dearer picture is black";
  EXPECT_FALSE(sampled_error("homogeneity.h_abs", known, dark)) << "it was not told";
  EXPECT_FALSE(sampled_error("homogeneity.mean", {{"homogeneity.mean", 0.0}}, dark));
}

}  // namespace
}  // namespace glint::sampled_error_test
