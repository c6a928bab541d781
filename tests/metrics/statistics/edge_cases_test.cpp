// SPDX-License-Identifier: GPL-3.0-or-later
//
// Fewest samples, extreme confidences, trials that tell nothing.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "metrics/statistics/estimate.h"
#include "metrics/statistics/matched_filter.h"
#include "metrics/statistics/pod.h"
#include "metrics/statistics/roc.h"

namespace glint {
namespace {

constexpr double kNearlyOne = 1.0 - 1e-15;

void expect_ordered(const Estimate& estimate, double minimum, double maximum) {
  EXPECT_LE(estimate.low, estimate.value);
  EXPECT_GE(estimate.high, estimate.value);
  EXPECT_GE(estimate.low, minimum);
  EXPECT_LE(estimate.high, maximum);
}

TEST(StatisticsEdges, IntervalsHoldTheirValueAtAnyConfidence) {
  for (const double confidence : {1e-12, 0.5, 0.95, kNearlyOne}) {
    for (const std::int64_t hits : {0, 1, 2}) {
      expect_ordered(wilson(hits, 2, confidence), 0.0, 1.0);
    }
    expect_ordered(wilson(1, 1, confidence), 0.0, 1.0);
    expect_ordered(poisson_rate(1000, 10.0, confidence), 0.0, 1000.0);
    expect_ordered(mean_of(std::array{1.0, 1.0}, confidence), 1.0, 1.0);
    for (const double with : {-1.0, 0.0, 1.0}) {
      expect_ordered(area_under_roc(std::array{with}, std::array{0.0}, confidence), 0.0, 1.0);
    }
  }
  EXPECT_DEATH(wilson(1, 2, 1.0), "confidence");
  EXPECT_DEATH(mean_of(std::array{1.0, 2.0}, 0.0), "confidence");
  EXPECT_DEATH(area_under_roc(std::array{1.0}, std::array{0.0}, 1.0), "probability");
}

// One against one says next to nothing: the interval is nearly all of [0, 1].
TEST(StatisticsEdges, TheAreaOfOneSampleEachIsHardlyKnown) {
  const Estimate won = area_under_roc(std::array{1.0}, std::array{0.0});
  EXPECT_EQ(won.value, 1.0);
  EXPECT_EQ(won.high, 1.0);
  EXPECT_LT(won.low, 0.3);
  EXPECT_DEATH(area_under_roc({}, std::array{0.0}), "figures of things");
}

TEST(StatisticsEdges, BootstrapRefusesFiguresThatAreNoNumber) {
  const auto undefined = [](std::span<const std::size_t> chosen) {
    return chosen[0] == chosen[1] ? std::numeric_limits<double>::quiet_NaN() : 1.0;
  };
  EXPECT_DEATH(bootstrap(5, undefined, 200, 1), "not a number");
}

void expect_a_curve_or_none(const std::optional<PodFit>& fit) {
  if (fit.has_value()) {
    EXPECT_GT(fit->slope, 0.0);
    EXPECT_FALSE(std::isnan(fit->a50));
    EXPECT_FALSE(std::isnan(fit->a90_95));
    EXPECT_LE(fit->a90.low, fit->a90.value);
    EXPECT_GE(fit->a90.high, fit->a90.value);
  }
}

TEST(StatisticsEdges, CurvesOfOneSizeAreNone) {
  std::vector<SizedTrial> trials;
  for (int i = 0; i < 20; ++i) {
    trials.push_back({.size = 3.0, .is_hit = i % 2 == 0});
  }
  EXPECT_FALSE(fit_pod(trials).has_value());
  EXPECT_FALSE(fit_pod({}).has_value());
  EXPECT_FALSE(fit_pod(std::array{SizedTrial{1.0, true}}).has_value());
  EXPECT_DEATH(fit_pod(std::array{SizedTrial{0.0, true}}), "sizes are positive");
}

// Few trials of any kind: sizes nearly equal, far apart, nearly separated.
TEST(StatisticsEdges, CurvesOfAnyTrialsAreSoundOrNone) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    Rng rng(61, Stream::kTest, i);
    const auto count = static_cast<int>(rng.uniform(2.0, 12.0));
    const double spread = std::pow(10.0, rng.uniform(-6.0, 3.0));
    std::vector<SizedTrial> trials;
    for (int k = 0; k < count; ++k) {
      const double ln_size = spread * std::floor(rng.uniform(-3.0, 4.0));
      trials.push_back(
          {.size = std::exp(std::clamp(ln_size, -600.0, 600.0)), .is_hit = rng.uniform() < 0.5});
    }
    expect_a_curve_or_none(fit_pod(trials));
  }
}

TEST(StatisticsEdges, DprimeOfOnePixelAndTwoWindowsIsANumber) {
  const double d = dprime(std::array{1.0}, std::vector<std::vector<double>>{{0.0}, {2.0}});
  EXPECT_TRUE(std::isfinite(d));
  EXPECT_GT(d, 0.0);
  const std::vector<std::vector<double>> partly = {{0.0, 1.0}, {0.0, 3.0}, {0.0, 2.0}};
  EXPECT_TRUE(std::isfinite(dprime(std::array{0.0, 1.0}, partly)));
}

}  // namespace
}  // namespace glint
