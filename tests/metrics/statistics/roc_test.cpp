// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/roc.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "metrics/statistics/quantiles.h"
#include "tests/metrics/statistics/coverage.h"

namespace glint {
namespace {

std::vector<double> gaussian(Rng& rng, int count, double mean) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    values.push_back(mean + rng.normal());
  }
  return values;
}

TEST(AreaUnderRoc, IsWorkedByHandForTwoAgainstTwo) {
  // Pairs of 3, 2 against 2, 1: three won, one drawn: 3.5 / 4. Placements 1, 0.75 and 0, 0.25, both
  // of variance 0.03125; 0.03125 (1/2 + 1/2) in all. Logit ln 7 -+ 1.95996 sqrt(0.03125) / 0.109375
  // = 1.945910 -+ 3.167774.
  const Estimate area = area_under_roc(std::array{3.0, 2.0}, std::array{2.0, 1.0});
  EXPECT_DOUBLE_EQ(area.value, 0.875);
  EXPECT_NEAR(area.low, 1.0 / (1.0 + std::exp(1.221864)), 1e-5);
  EXPECT_NEAR(area.high, 1.0 / (1.0 + std::exp(-5.113684)), 1e-5);
}

TEST(AreaUnderRoc, IsTheShareOfPairsThatAreWonAndHalfOfThoseDrawn) {
  Rng rng(1, Stream::kTest, 0);
  for (int repeat = 0; repeat < 100; ++repeat) {
    std::vector<double> with;
    std::vector<double> without;
    for (int i = 0; i < 15; ++i) {  // few levels, so that there are ties
      with.push_back(std::floor(rng.uniform(2.0, 9.0)));
      without.push_back(std::floor(rng.uniform(0.0, 7.0)));
    }
    double won = 0.0;
    for (const double a : with) {
      for (const double b : without) {
        won += a > b ? 1.0 : a == b ? 0.5 : 0.0;
      }
    }
    EXPECT_NEAR(area_under_roc(with, without).value, won / (15.0 * 15.0), 1e-12);
  }
}

TEST(AreaUnderRoc, TurnsOverWhenTheSidesAreExchanged) {
  Rng rng(2, Stream::kTest, 0);
  const auto with = gaussian(rng, 40, 1.0);
  const auto without = gaussian(rng, 25, 0.0);
  const Estimate area = area_under_roc(with, without);
  const Estimate turned = area_under_roc(without, with);
  EXPECT_NEAR(turned.value, 1.0 - area.value, 1e-12);
  EXPECT_NEAR(turned.low, 1.0 - area.high, 1e-12);
  EXPECT_NEAR(turned.high, 1.0 - area.low, 1e-12);
}

TEST(AreaUnderRoc, OfPerfectSeparationIsNotCertain) {
  // The low end solves 1 - a = z sqrt(V(a)); ten against ten are 9 more of each in V.
  const std::vector<double> with(10, 2.0);
  const std::vector<double> without(10, 1.0);
  const Estimate area = area_under_roc(with, without);
  EXPECT_NEAR(area.value, 1.0, 1e-12);
  EXPECT_EQ(area.high, 1.0);
  const double a = area.low;
  const double variance =
      a * (1.0 - a) * (1.0 + 9.0 * ((1.0 - a) / (2.0 - a) + a / (1.0 + a))) / 100.0;
  EXPECT_NEAR(1.0 - a, 1.959964 * std::sqrt(variance), 1e-6);
  EXPECT_GT(a, 0.7);
  EXPECT_LT(a, 0.95);
  const Estimate wrong = area_under_roc(without, with);
  EXPECT_EQ(wrong.low, 0.0);
  EXPECT_NEAR(wrong.high, 1.0 - a, 1e-9);
}

TEST(AreaUnderRoc, OfEqualFiguresIsAHalfAndUncertain) {
  const std::vector<double> same(20, 1.0);
  const Estimate area = area_under_roc(same, same);
  EXPECT_NEAR(area.value, 0.5, 1e-12);
  EXPECT_LT(area.low, 0.4);
  EXPECT_GT(area.high, 0.6);
}

/// Of two Gaussians of the same width d' apart: Phi(d' / sqrt 2).
double area_for_dprime(double dprime) {
  return normal_cdf(dprime / std::numbers::sqrt2);
}

TEST(AreaUnderRoc, OfTwoGaussiansIsTheClosedForm) {
  for (const double distance : {0.5, 1.0, 2.0, 3.0}) {
    Rng rng(3, Stream::kTest, 0);
    const Estimate area = area_under_roc(gaussian(rng, 40000, distance), gaussian(rng, 40000, 0.0));
    EXPECT_NEAR(area.value / area_for_dprime(distance), 1.0, 0.01) << distance;
  }
}

TEST(AreaUnderRoc, HoldsTheTruthNineteenTimesOfTwenty) {
  for (const double truth : {0.75, 0.9, 0.97}) {
    const double distance = std::numbers::sqrt2 * normal_quantile(truth);
    const double held = testing::coverage(4, [&](Rng& rng) {
      const Estimate area = area_under_roc(gaussian(rng, 100, distance), gaussian(rng, 100, 0.0));
      return area.low <= truth && truth <= area.high;
    });
    RecordProperty("coverage_" + std::to_string(truth), std::to_string(held));
    EXPECT_GT(held, 0.93) << truth;
    EXPECT_LT(held, 0.97) << truth;
  }
}

TEST(AreaUnderRoc, RefusesWhatIsNoNumber) {
  const std::array wrong = {1.0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_DEATH(area_under_roc(wrong, std::array{1.0}), "not a number");
  EXPECT_DEATH(area_under_roc(std::array{1.0}, std::vector<double>()), "are needed");
}

}  // namespace
}  // namespace glint
