// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/pod.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/metrics/statistics/coverage.h"

namespace glint {
namespace {

constexpr double kTrueA50 = 0.4;
constexpr double kTrueSlope = 4.0;

double true_pod(double size) {
  return 1.0 / (1.0 + std::exp(-kTrueSlope * std::log(size / kTrueA50)));
}

/// Where it is 9/10: ln 9 = 2.197 = 4 ln(a / 0.4).
const double kTrueA90 = kTrueA50 * std::exp(std::log(9.0) / kTrueSlope);

/// Sizes evenly in ln from 0.1 to 1.6, as a designed experiment has them.
std::vector<SizedTrial> simulated_trials(Rng& rng, int count) {
  std::vector<SizedTrial> trials;
  for (int i = 0; i < count; ++i) {
    const double size = 0.1 * std::pow(16.0, (i + 0.5) / count);
    trials.push_back({.size = size, .is_hit = rng.uniform() < true_pod(size)});
  }
  return trials;
}

TEST(FitPod, IsWorkedByHandForTwoSizes) {
  // Two sizes and two numbers: the curve goes through the shares. 10 of 40 at size 1: logit
  // -ln 3 = intercept. 30 of 40 at size 2: ln 3 = intercept + slope ln 2, slope = 2 ln 3 / ln 2.
  std::vector<SizedTrial> trials;
  for (int i = 0; i < 40; ++i) {
    trials.push_back({.size = 1.0, .is_hit = i < 10});
    trials.push_back({.size = 2.0, .is_hit = i < 30});
  }
  const auto fit = fit_pod(trials);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->intercept, -std::log(3.0), 1e-8);
  EXPECT_NEAR(fit->slope, 2.0 * std::log(3.0) / std::log(2.0), 1e-8);
  EXPECT_NEAR(fit->a50, std::sqrt(2.0), 1e-8);
  // ln 9 = -ln 3 + slope ln a: ln a = 3 ln 3 / slope = 1.5 ln 2.
  EXPECT_NEAR(fit->a90.value, std::pow(2.0, 1.5), 1e-8);
  // Logits of shares of 40 have variance 1 / (40 * 0.25 * 0.75) = 0.133333 each; the intercept is
  // the first one, the slope their difference over ln 2.
  EXPECT_NEAR(fit->variance_intercept, 0.1333333, 1e-6);
  EXPECT_NEAR(fit->variance_slope, 0.2666667 / std::pow(std::log(2.0), 2), 1e-6);
  EXPECT_NEAR(fit->covariance, -0.1333333 / std::log(2.0), 1e-6);
  // At size 2 the interval is that of a share: ln 3 -+ 1.95996 sqrt(0.133333).
  EXPECT_NEAR(fit->at(2.0).value, 0.75, 1e-9);
  EXPECT_NEAR(fit->at(2.0).low, 1.0 / (1.0 + std::exp(-(1.0986123 - 0.7156777))), 1e-6);
}

TEST(FitPod, ScalesWithTheUnitOfSize) {
  Rng rng(1, Stream::kTest, 0);
  std::vector<SizedTrial> in_mm = simulated_trials(rng, 200);
  std::vector<SizedTrial> in_um = in_mm;
  for (SizedTrial& trial : in_um) {
    trial.size *= 1000.0;
  }
  const auto mm = fit_pod(in_mm);
  const auto um = fit_pod(in_um);
  ASSERT_TRUE(mm && um);
  EXPECT_NEAR(um->a90.value / mm->a90.value, 1000.0, 1e-5);
  EXPECT_NEAR(um->a90_95 / mm->a90_95, 1000.0, 1e-5);
  EXPECT_NEAR(um->at(500.0).low, mm->at(0.5).low, 1e-8);
}

/// Log-likelihood of 90 % at a place plus half the ln of the information's determinant, plainly.
double penalised_likelihood(const std::vector<SizedTrial>& trials, double place, double slope) {
  double sum = 0.0;
  double j_ii = 0.0;
  double j_is = 0.0;
  double j_ss = 0.0;
  for (const SizedTrial& trial : trials) {
    const double x = std::log(trial.size);
    const double p = 1.0 / (1.0 + std::exp(-std::log(9.0) - slope * (x - std::log(place))));
    sum += std::log(trial.is_hit ? p : 1.0 - p);
    j_ii += p * (1.0 - p);
    j_is += p * (1.0 - p) * x;
    j_ss += p * (1.0 - p) * x * x;
  }
  return sum + 0.5 * std::log(j_ii * j_ss - j_is * j_is);
}

/// Of any curve that rises, by steps that halve when none of them gains.
double largest_penalised_likelihood(const std::vector<SizedTrial>& trials,
                                    double place,
                                    double slope) {
  double best = penalised_likelihood(trials, place, slope);
  for (double step = 0.1; step > 1e-6;) {
    bool has_gained = false;
    for (const auto& [by_place, by_slope] : {std::pair(1.0 + step, 1.0),
                                             std::pair(1.0 - step, 1.0),
                                             std::pair(1.0, 1.0 + step),
                                             std::pair(1.0, 1.0 - step)}) {
      const double other = penalised_likelihood(trials, place * by_place, slope * by_slope);
      if (other > best) {
        best = other;
        place *= by_place;
        slope *= by_slope;
        has_gained = true;
      }
    }
    step *= has_gained ? 1.0 : 0.5;
  }
  return best;
}

TEST(FitPod, EndsTheIntervalWhereTheLikelihoodHasDroppedByHalfOfChiSquare) {
  Rng rng(2, Stream::kTest, 0);
  const auto trials = simulated_trials(rng, 150);
  const auto fit = fit_pod(trials);
  ASSERT_TRUE(fit);
  const double best = largest_penalised_likelihood(trials, fit->a90.value, fit->slope);
  for (const double end : {fit->a90.low, fit->a90.high}) {
    double through = -std::numeric_limits<double>::infinity();
    double slope = 0.5;
    while (slope < 15.0) {
      through = std::max(through, penalised_likelihood(trials, end, slope));
      slope += 0.005;
    }
    EXPECT_NEAR(best - through, 0.5 * 3.841459, 1e-3);
  }
  EXPECT_LT(fit->a90.value, fit->a90_95);
  EXPECT_LT(fit->a90_95, fit->a90.high);  // one-sided is nearer than two-sided
}

TEST(FitPod, HasNoAnswerForSeparatedOrFallingOrOneSidedTrials) {
  const auto trial = [](double size, bool is_hit) { return SizedTrial{size, is_hit}; };
  EXPECT_FALSE(fit_pod(std::vector<SizedTrial>()));
  EXPECT_FALSE(fit_pod(std::array{trial(1, true), trial(2, true), trial(3, true)}));
  EXPECT_FALSE(fit_pod(std::array{trial(1, false), trial(2, false)}));
  EXPECT_FALSE(fit_pod(std::array{trial(1, false), trial(2, false), trial(3, true)}));
  EXPECT_FALSE(fit_pod(std::array{
      trial(1, false), trial(2, false), trial(2, true), trial(3, true)}));  // but for ties
  EXPECT_FALSE(fit_pod(std::array{
      trial(1, true), trial(2, true), trial(2.5, false), trial(2.2, false), trial(2.3, true)}));
  EXPECT_TRUE(
      fit_pod(std::array{trial(1, false), trial(2, true), trial(3, false), trial(4, true)}));
}

TEST(FitPod, OfTrialsThatHardlyRiseHasNoUpperEnd) {
  std::vector<SizedTrial> trials;
  for (int i = 0; i < 40; ++i) {
    trials.push_back({.size = 1.0, .is_hit = i < 19});
    trials.push_back({.size = 2.0, .is_hit = i < 21});
  }
  const auto fit = fit_pod(trials);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->a90.high, std::numeric_limits<double>::infinity());
  EXPECT_EQ(fit->a90_95, std::numeric_limits<double>::infinity());
  EXPECT_GT(fit->a90.low, 2.0);  // half were found there
}

TEST(FitPod, RecoversAKnownA90WithinItsInterval) {
  int held = 0;
  for (std::uint64_t i = 0; i < 20; ++i) {
    Rng rng(3, Stream::kTest, i);
    const auto fit = fit_pod(simulated_trials(rng, 2000));
    ASSERT_TRUE(fit);
    held += fit->a90.low < kTrueA90 && kTrueA90 < fit->a90.high ? 1 : 0;
    EXPECT_NEAR(fit->a90.value / kTrueA90, 1.0, 0.12);
    EXPECT_LT(fit->a90.high / fit->a90.low, 1.3);
  }
  EXPECT_GE(held, 17);  // of 20 at 95 %; 16 or fewer happen once in 60 times
}

TEST(FitPod, HoldsTheTrueSizeAndCurveNineteenTimesOfTwenty) {
  for (const int count : {120, 300}) {
    int fits = 0;
    int one_sided = 0;
    int at_low_pod = 0;
    int at_high_pod = 0;
    const double held = testing::coverage(4, [&](Rng& rng) {
      const auto fit = fit_pod(simulated_trials(rng, count));
      if (!fit) {
        return false;
      }
      ++fits;
      one_sided += fit->a90_95 >= kTrueA90 ? 1 : 0;
      const Estimate low = fit->at(0.3);
      const Estimate high = fit->at(0.8);
      at_low_pod += low.low <= true_pod(0.3) && true_pod(0.3) <= low.high ? 1 : 0;
      at_high_pod += high.low <= true_pod(0.8) && true_pod(0.8) <= high.high ? 1 : 0;
      return fit->a90.low <= kTrueA90 && kTrueA90 <= fit->a90.high;
    });
    EXPECT_EQ(fits, 1000);
    RecordProperty("a90_" + std::to_string(count), std::to_string(held));
    RecordProperty("a90_95_" + std::to_string(count), one_sided);
    RecordProperty("at_0.3_" + std::to_string(count), at_low_pod);
    RecordProperty("at_0.8_" + std::to_string(count), at_high_pod);
    for (const double share :
         {held, one_sided / 1000.0, at_low_pod / 1000.0, at_high_pod / 1000.0}) {
      EXPECT_GT(share, 0.93) << count;
      EXPECT_LT(share, 0.97) << count;
    }
  }
}

}  // namespace
}  // namespace glint
