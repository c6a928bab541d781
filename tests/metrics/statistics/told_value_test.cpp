// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/told_value.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/rng.h"

namespace glint {
namespace {

TEST(ToldValue, WeighsReplicatesAndTheModelByWhatTheyKnow) {
  // Mean 10, variance of one 4, so that four are as good as a weight of 1; the model's sd of 0 and
  // the noise of the search's own numbers make a weight of 1/4: (10 + 9 / 4) / (1 + 1 / 4) = 9.8.
  const std::vector<double> values = {
      10.0 - std::sqrt(3.0) * std::sqrt(2.0), 10.0, 10.0, 10.0 + std::sqrt(3.0) * std::sqrt(2.0)};
  const ModelledScore model = {.mean = 9.0, .sd = 0.0};
  const Estimate told = told_value(values, 0.0, model);
  EXPECT_NEAR(told.value, 9.8, 1e-12);
  // Student with 3 degrees: 3.1824 / sqrt(1.25).
  EXPECT_NEAR(told.high - told.value, 2.8464, 1e-3);
  EXPECT_NEAR(told_value(values, 0.0).value, 10.0, 1e-12);
}

TEST(ToldValue, IsNoSurerThanTheScoreItselfSays) {
  const std::vector<double> alike = {5.0, 5.0, 5.0, 5.0};
  EXPECT_EQ(told_value(alike, 0.0).low, 5.0);
  // 3.1824 x 0.6 / sqrt(4)
  EXPECT_NEAR(told_value(alike, 0.6).low, 5.0 - 0.9547, 1e-3);
}

/// The best of twenty designs by one noisy evaluation each: what was seen of it is too good, what
/// is told is right in 90 to 98 of 100 cases.
TEST(ToldValue, CoversTheTruthWhereWhatWasSeenIsTooGood) {
  int covered = 0;
  double seen_bias = 0.0;
  double told_bias = 0.0;
  constexpr int kCases = 400;
  for (int i = 0; i < kCases; ++i) {
    Rng rng(3, Stream::kTest, static_cast<std::uint64_t>(i));
    double truth = 0.0;
    double seen = -1e9;
    for (int k = 0; k < 20; ++k) {
      const double one = rng.normal();
      if (const double value = one + rng.normal(); value > seen) {
        truth = one;
        seen = value;
      }
    }
    // What Bayes makes of a prior and an evaluation of variance 1.
    const ModelledScore model = {.mean = 0.5 * seen, .sd = std::sqrt(0.5)};
    std::vector<double> values;
    for (int k = 0; k < 8; ++k) {
      values.push_back(truth + rng.normal());
    }
    const Estimate told = told_value(values, 0.0, model);
    covered += told.low <= truth && truth <= told.high ? 1 : 0;
    seen_bias += (seen - truth) / kCases;
    told_bias += (told.value - truth) / kCases;
  }
  EXPECT_GE(covered, 360);
  EXPECT_LE(covered, 392);
  EXPECT_GT(seen_bias, 0.5);
  EXPECT_LT(std::abs(told_bias), 0.06);
}

}  // namespace
}  // namespace glint
