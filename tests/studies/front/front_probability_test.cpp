// SPDX-License-Identifier: GPL-3.0-or-later
//
// Probabilities of being the compromise, against closed forms.
#include "studies/front/front_probability.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// A score of the lighting, which is exact.
constexpr const char* kWidth = "lighting.width_mm";

/// Much of "even", little of the width, by weights.
Goal weighted_goal(double weight_of_width = 1.0) {
  return {.objective = {.name = "even"},
          .constraints = {{.name = "cnr", .min = 3.0, .max = std::nullopt}},
          .more_objectives = {{.name = kWidth, .is_maximised = false, .weight = weight_of_width}},
          .choice = ChoiceRule::kWeights};
}

/// "even" from 0 to 10 and the width from 0 to 100.
Json front_of_two() {
  return {
      {"designs",
       {{{"trial", 3}, {"folder", "winner"}, {"scores", {{"even", 10}, {kWidth, 100}}}},
        {{"trial", 5}, {"folder", "front/trial_005"}, {"scores", {{"even", 0}, {kWidth, 0}}}}}}};
}

Finalist finalist(const std::string& key, double even, double width, double error) {
  return {.key = key,
          .title = "Design " + key,
          .written = {{"rescored",
                       {{"even", even}, {"even.error", error}, {kWidth, width}, {"cnr", 4.0}}}}};
}

double normal_below(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

// By the weights a costs 0.3 + 0.6 and b 0.5 + 0.3 in parts of the ranges. Their difference is 0.1
// in the mean, and of the errors 0.8 and 0.6 in "even" its standard deviation is 0.1: one of them.
TEST(ProbabilityOfChoice, IsThatOfADifferenceOfNormalErrors) {
  const std::vector<Finalist> two = {finalist("a", 7.0, 60.0, 0.8), finalist("b", 5.0, 30.0, 0.6)};
  const std::vector<double> found = probabilities_of_choice(weighted_goal(), front_of_two(), two);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[1], normal_below(1.0), 0.02);  // 4000 samples: 3 standard errors
  EXPECT_NEAR(found[0] + found[1], 1.0, 1e-9);
  // Width counts 5/3: 0.3 + 1.0 against 0.5 + 0.5 are three standard deviations.
  const std::vector<double> sure =
      probabilities_of_choice(weighted_goal(5.0 / 3.0), front_of_two(), two);
  EXPECT_NEAR(sure[1], normal_below(3.0), 0.005);
}

Finalist scanned(const std::string& key,
                 double even,
                 double width,
                 const std::vector<double>& scans) {
  Finalist one = finalist(key, even, width, 0.0);
  one.written["rescored"].erase("even.error");
  for (const double scan : scans) {
    one.written["repeated"]["even"].push_back(even + scan);
  }
  return one;
}

// Noise that all scans share is 50 times what the designs differ by, and cancels.
TEST(ProbabilityOfChoice, NoiseThatAllShareCancels) {
  const std::vector<double> shared = {5, -3, 2, -6, 4, -1, 3, -4};
  const std::vector<Finalist> two = {scanned("a", 7.0, 60.0, shared),
                                     scanned("b", 5.0, 39.0, shared)};
  const std::vector<double> found = probabilities_of_choice(weighted_goal(), front_of_two(), two);
  EXPECT_NEAR(found[1], 1.0, 1e-9) << "0.3 + 0.6 against 0.5 + 0.39";
  // Of their own the same noise leaves it open.
  std::vector<double> other = shared;
  std::rotate(other.begin(), other.begin() + 3, other.end());
  const std::vector<double> open = probabilities_of_choice(
      weighted_goal(), front_of_two(), {two[0], scanned("b", 5.0, 39.0, other)});
  EXPECT_GT(open[0], 0.3);
  EXPECT_LT(open[0], 0.7);
}

// Eight scans whose differences have a mean of 1.5 of its standard errors: Student's
// distribution with 7 degrees of freedom, here at 1.5.
TEST(ProbabilityOfChoice, FewScansAreStudents) {
  const std::vector<double> noise = {0.9, -0.4, 0.2, -0.7, 0.5, -0.1, 0.3, -0.7};
  double squares = 0.0;
  for (const double one : noise) {
    squares += one * one;
  }
  const double error = std::sqrt(squares / 7.0 / 8.0) / 10.0;  // in parts of the range
  const double lead = 1.5 * error;
  const std::vector<Finalist> two = {
      scanned("a", 7.0, 60.0, noise),
      scanned("b", 5.0, 100.0 * (0.4 - lead), std::vector<double>(8, 0.0))};
  const std::vector<double> found = probabilities_of_choice(weighted_goal(), front_of_two(), two);
  EXPECT_NEAR(found[1], 0.9114, 0.025);
}

TEST(ProbabilityOfChoice, WhatMissesALimitIsNotTakenUnlessAllDo) {
  Finalist blind = finalist("a", 9.0, 10.0, 0.1);
  blind.written["rescored"]["cnr"] = 2.0;
  const Finalist seeing = finalist("b", 5.0, 30.0, 0.1);
  const auto of = [](const std::vector<Finalist>& all) {
    return probabilities_of_choice(weighted_goal(), front_of_two(), all);
  };
  EXPECT_EQ(of({blind, seeing}), (std::vector<double>{0.0, of({blind, seeing})[1]}));
  EXPECT_NEAR(of({blind, seeing})[1], 1.0, 1e-9);
  Finalist other = seeing;
  other.written["rescored"]["cnr"] = 2.9;
  EXPECT_NEAR(of({blind, other})[0], 1.0, 1e-9);
  EXPECT_TRUE(of({seeing}).empty()) << "one alone";
}

// An interval of 95 %, of trials that are not scanned again: four standard errors wide.
TEST(ProbabilityOfChoice, AnIntervalIsFourStandardErrorsWide) {
  const auto with_interval = [](const std::string& key, double even, double width, double error) {
    Finalist one = finalist(key, even, width, 0.0);
    one.written["rescored"].erase("even.error");
    one.written["rescored"]["even.low"] = even - 3.0 * error;  // need not be even on both sides
    one.written["rescored"]["even.high"] = even + error;
    return one;
  };
  const std::vector<double> found = probabilities_of_choice(
      weighted_goal(),
      front_of_two(),
      {with_interval("a", 7.0, 60.0, 0.8), with_interval("b", 5.0, 30.0, 0.6)});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[1], normal_below(1.0), 0.02);
}

// One finalist has a standard error and no scans (a tunnel of mirrors, path traced); the other has
// scans alone, with a standard deviation of 0.6.
TEST(ProbabilityOfChoice, ScansOfOneAloneAreItsStandardError) {
  const std::vector<Finalist> two = {finalist("a", 7.0, 60.0, 0.8),
                                     scanned("b", 5.0, 30.0, {-0.6, 0.0, 0.6})};
  const std::vector<double> found = probabilities_of_choice(weighted_goal(), front_of_two(), two);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[1], normal_below(1.0), 0.02);
}

// One finalist could not be scanned again and tells no error: it is not exact.
TEST(ProbabilityOfChoice, IsNotToldWhereNoiseIsNotKnown) {
  const std::vector<Finalist> two = {scanned("a", 7.0, 60.0, {}),
                                     scanned("b", 5.0, 30.0, {-0.6, 0.0, 0.6})};
  EXPECT_TRUE(probabilities_of_choice(weighted_goal(), front_of_two(), two).empty());
  Json front = front_of_two();
  Json result = Json::object();
  add_probability_best(weighted_goal(), two, front, result);
  EXPECT_FALSE(result.contains("probability_best"));
  EXPECT_EQ(result["probability_best_unknown"],
            "how far noise moves even of Design a is not known");
  EXPECT_FALSE(front["designs"][0].contains("probability_best"));
}

// No design of the search keeps the limits: two prototypes are all that there is.
TEST(ProbabilityOfChoice, WithoutAFrontThereIsNone) {
  const std::vector<Finalist> prototypes = {finalist("a", 7.0, 60.0, 0.8),
                                            finalist("b", 5.0, 30.0, 0.6)};
  Json front = {{"designs", Json::array()}};
  EXPECT_TRUE(probabilities_of_choice(weighted_goal(), front, prototypes).empty());
  Json result = Json::object();
  add_probability_best(weighted_goal(), prototypes, front, result);
  EXPECT_FALSE(result.contains("probability_best"));
}

TEST(ProbabilityOfChoice, StandsInResultAndFront) {
  Json front = front_of_two();
  Json result = Json::object();
  add_probability_best(weighted_goal(),
                       {finalist("half", 1.0, 99.0, 0.1),
                        finalist("winner", 7.0, 60.0, 0.8),
                        finalist("front/trial_005", 5.0, 30.0, 0.6)},
                       front,
                       result);
  ASSERT_EQ(result["probability_best"].size(), 3U);
  EXPECT_EQ(result["probability_best"][0]["key"], "front/trial_005");
  EXPECT_EQ(result["probability_best"][0]["title"], "Design front/trial_005");
  EXPECT_EQ(result["probability_best"][2]["probability"], 0.0);
  EXPECT_EQ(front["designs"][1]["probability_best"], result["probability_best"][0]["probability"]);
  EXPECT_EQ(front["designs"][0]["probability_best"], result["probability_best"][1]["probability"]);
}

}  // namespace
}  // namespace glint
