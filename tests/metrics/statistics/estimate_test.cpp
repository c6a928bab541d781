// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "metrics/statistics/quantiles.h"
#include "tests/metrics/statistics/coverage.h"

namespace glint {
namespace {

using testing::coverage;

bool holds(const Estimate& estimate, double truth) {
  return estimate.low <= truth && truth <= estimate.high;
}

/// Chance that an interval of the counts 0 ... n holds a share: the sum over the binomial.
double wilson_coverage(int n, double share) {
  double sum = 0.0;
  for (int k = 0; k <= n; ++k) {
    const double ln_chance = std::lgamma(n + 1.0) - std::lgamma(k + 1.0) -
                             std::lgamma(n - k + 1.0) + k * std::log(share) +
                             (n - k) * std::log1p(-share);
    sum += holds(wilson(k, n), share) ? std::exp(ln_chance) : 0.0;
  }
  return sum;
}

double garwood_coverage(double mean) {
  double sum = 0.0;
  for (int k = 0; k <= 200; ++k) {
    const double chance = std::exp(-mean + k * std::log(mean) - std::lgamma(k + 1.0));
    sum += holds(poisson_rate(k, 1.0), mean) ? chance : 0.0;
  }
  return sum;
}

double mean_at(const std::vector<double>& values, std::span<const std::size_t> chosen) {
  double sum = 0.0;
  for (const std::size_t index : chosen) {
    sum += values[index];
  }
  return sum / static_cast<double>(chosen.size());
}

double median_at(const std::vector<double>& values, std::span<const std::size_t> chosen) {
  std::vector<double> picked;
  for (const std::size_t index : chosen) {
    picked.push_back(values[index]);
  }
  const auto middle = picked.begin() + static_cast<std::ptrdiff_t>(picked.size() / 2);
  std::nth_element(picked.begin(), middle, picked.end());
  return *middle;
}

TEST(NormalQuantile, IsThatOfTablesAndUndoesTheDistribution) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(normal_quantile(0.95), 1.6448536269514722, 1e-12);
  EXPECT_NEAR(normal_cdf(1.0), 0.8413447460685429, 1e-14);
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const double p = rng.uniform(1e-9, 1.0 - 1e-9);
    EXPECT_NEAR(normal_cdf(normal_quantile(p)), p, 1e-13);
  }
}

// 9 / (9 + 1), and that of the other side.
TEST(Logistic, IsTheInverseOfTheLogarithmOfTheOdds) {
  EXPECT_NEAR(logistic(std::log(9.0)), 0.9, 1e-15);
  EXPECT_NEAR(logistic(-std::log(9.0)), 0.1, 1e-15);
  EXPECT_EQ(logistic(0.0), 0.5);
  EXPECT_EQ(logistic(-1000.0), 0.0);
  EXPECT_EQ(logistic(1000.0), 1.0);
  for (const double x : {0.1, 1.0, 7.0, 30.0}) {
    EXPECT_EQ(logistic(-x), 1.0 - logistic(x));
  }
}

TEST(TQuantile, IsThatOfTables) {
  EXPECT_NEAR(t_quantile(0.975, 1.0), 12.706204736, 1e-8);  // tan(0.475 pi)
  EXPECT_NEAR(t_quantile(0.975, 2.0), 4.302652730, 1e-8);
  EXPECT_NEAR(t_quantile(0.975, 10.0), 2.228138852, 1e-8);
  EXPECT_NEAR(t_quantile(0.025, 10.0), -2.228138852, 1e-8);
  EXPECT_NEAR(t_quantile(0.975, 1e7), normal_quantile(0.975), 1e-6);
}

TEST(GammaQuantile, IsThatOfTheExponentialAndOfChiSquareTables) {
  EXPECT_NEAR(gamma_quantile(0.975, 1.0), -std::log(0.025), 1e-12);
  EXPECT_NEAR(2.0 * gamma_quantile(0.95, 0.5), 3.841458821, 1e-8);   // chi-square, 1 degree
  EXPECT_NEAR(2.0 * gamma_quantile(0.95, 5.0), 18.307038053, 1e-8);  // and 10
}

TEST(Wilson, IsTheIntervalWorkedByHandForEightOfTen) {
  // z = 1.95996, z^2 = 3.84146: centre (0.8 + 0.192073) / 1.384146 = 0.716740, half width
  // 1.95996 sqrt(0.016 + 0.0096036) / 1.384146 = 0.226578.
  const Estimate estimate = wilson(8, 10);
  EXPECT_DOUBLE_EQ(estimate.value, 0.8);
  EXPECT_NEAR(estimate.low, 0.490162, 1e-6);
  EXPECT_NEAR(estimate.high, 0.943318, 1e-6);
}

TEST(Wilson, OfNoHitsEndsAtZeroAndMirrorsAllHits) {
  // high = z^2 / (n + z^2) = 3.84146 / 303.84146
  const Estimate none = wilson(0, 300);
  const Estimate all = wilson(300, 300);
  EXPECT_EQ(none.low, 0.0);
  EXPECT_NEAR(none.high, 0.0126430, 1e-7);
  EXPECT_EQ(all.high, 1.0);
  EXPECT_NEAR(all.low, 1.0 - none.high, 1e-12);
}

TEST(Wilson, HoldsTheTruthNineteenTimesOfTwenty) {
  for (const int n : {100, 300, 1000}) {
    for (const double share : {0.1, 0.5, 0.9}) {
      EXPECT_GT(wilson_coverage(n, share), 0.93) << n << " " << share;
      EXPECT_LT(wilson_coverage(n, share), 0.97) << n << " " << share;
    }
  }
  // Counts are discrete: with few events single shares stray, their average does not.
  double average = 0.0;
  for (int i = 0; i < 100; ++i) {
    average += wilson_coverage(50, 0.9 + 0.1 * (i + 0.5) / 100.0) / 100.0;
  }
  EXPECT_GT(average, 0.93);
  EXPECT_LT(average, 0.97);
}

TEST(Wilson, HoldsTheTruthInSimulatedTrials) {
  const double held = coverage(2, [](Rng& rng) {
    const double share = rng.uniform(0.02, 0.98);
    int hits = 0;
    for (int i = 0; i < 100; ++i) {
      hits += rng.uniform() < share ? 1 : 0;
    }
    return holds(wilson(hits, 100), share);
  });
  RecordProperty("coverage", std::to_string(held));
  EXPECT_GT(held, 0.93);
  EXPECT_LT(held, 0.97);
}

TEST(PoissonRate, IsGarwoodsInterval) {
  // No event: -ln 0.025 = 3.68888. Ten: half the chi-square quantiles 9.59078 and 36.7807.
  EXPECT_EQ(poisson_rate(0, 1.0).low, 0.0);
  EXPECT_NEAR(poisson_rate(0, 1.0).high, 3.688879, 1e-6);
  EXPECT_NEAR(poisson_rate(0, 300.0).high, 3.688879 / 300.0, 1e-8);
  EXPECT_NEAR(poisson_rate(10, 1.0).low, 4.795389, 1e-5);
  EXPECT_NEAR(poisson_rate(10, 1.0).high, 18.390356, 1e-5);
  EXPECT_DOUBLE_EQ(poisson_rate(10, 4.0).value, 2.5);
}

TEST(PoissonRate, NeverHoldsTheTruthLessThanPromisedAndForManyEventsNotMuchMore) {
  double mean = 0.1;
  while (mean < 100.0) {
    EXPECT_GE(garwood_coverage(mean), 0.95 - 1e-9) << mean;
    mean *= 1.05;
  }
  EXPECT_LT(garwood_coverage(50.0), 0.97);
  EXPECT_LT(garwood_coverage(90.0), 0.97);
}

TEST(MeanOf, IsStudentsIntervalWorkedByHand) {
  // 1 ... 5: mean 3, standard deviation sqrt 2.5, over sqrt 5 it is sqrt 0.5; t with 4 degrees of
  // freedom 2.776445: 3 -+ 1.963243.
  const Estimate estimate = mean_of(std::array{1.0, 2.0, 3.0, 4.0, 5.0});
  EXPECT_DOUBLE_EQ(estimate.value, 3.0);
  EXPECT_NEAR(estimate.low, 1.036757, 1e-6);
  EXPECT_NEAR(estimate.high, 4.963243, 1e-6);
}

TEST(MeanOf, HoldsTheTruthNineteenTimesOfTwentyEvenOfFewValues) {
  for (const int n : {3, 8, 30}) {
    const double held = coverage(3, [&](Rng& rng) {
      std::vector<double> values;
      for (int i = 0; i < n; ++i) {
        values.push_back(7.0 + 2.0 * rng.normal());
      }
      return holds(mean_of(values), 7.0);
    });
    RecordProperty("coverage_" + std::to_string(n), std::to_string(held));
    EXPECT_GT(held, 0.93) << n;
    EXPECT_LT(held, 0.97) << n;
  }
}

TEST(Bootstrap, OfAMeanComesCloseToStudentsInterval) {
  Rng rng(4, Stream::kTest, 0);
  std::vector<double> values;
  for (int i = 0; i < 200; ++i) {
    values.push_back(rng.normal());
  }
  const Estimate exact = mean_of(values);
  const Estimate estimate = bootstrap(
      200, [&](const auto& chosen) { return mean_at(values, chosen); }, 4000, 5);
  const double width = exact.high - exact.low;
  EXPECT_NEAR(estimate.value, exact.value, 1e-12);
  EXPECT_NEAR(estimate.low, exact.low, 0.05 * width);
  EXPECT_NEAR(estimate.high, exact.high, 0.05 * width);
}

TEST(Bootstrap, IsTheSameForTheSameSeedAndDiffersForAnother) {
  const std::vector<double> values = {1.0, 4.0, 9.0, 16.0, 25.0, 36.0, 49.0, 64.0};
  const auto statistic = [&](const auto& chosen) { return mean_at(values, chosen); };
  const Estimate first = bootstrap(8, statistic, 200, 1);
  EXPECT_EQ(first.low, bootstrap(8, statistic, 200, 1).low);
  EXPECT_EQ(first.high, bootstrap(8, statistic, 200, 1).high);
  EXPECT_NE(first.low, bootstrap(8, statistic, 200, 2).low);
}

// Of 30 things all are different, of those drawn again some 19: the figure is above all resampled
// ones, its median bias 3.29 (1 - 0.5 / 1000). Taken off twice both ends are the largest of them.
TEST(Bootstrap, TakesTheMedianBiasOffTwice) {
  const auto distinct = [](std::span<const std::size_t> chosen) {
    return static_cast<double>(std::set<std::size_t>(chosen.begin(), chosen.end()).size());
  };
  const Estimate estimate = bootstrap(30, distinct, 1000, 3);
  EXPECT_EQ(estimate.value, 30.0);
  EXPECT_EQ(estimate.low, estimate.high);
  EXPECT_GT(estimate.low, 22.0);
}

TEST(Bootstrap, OfAFigureThatNeverChangesIsThatFigure) {
  const Estimate estimate = bootstrap(
      10, [](const auto&) { return 0.25; }, 100, 1);
  EXPECT_EQ(estimate.low, 0.25);
  EXPECT_EQ(estimate.high, 0.25);
}

TEST(Bootstrap, LeansToTheLongTailWhereStudentsIntervalIsSymmetric) {
  Rng rng(6, Stream::kTest, 0);
  std::vector<double> values;
  for (int i = 0; i < 60; ++i) {
    values.push_back(-std::log(1.0 - rng.uniform()));
  }
  const Estimate estimate = bootstrap(
      60, [&](const auto& chosen) { return mean_at(values, chosen); }, 2000, 7);
  EXPECT_GT(estimate.high - estimate.value, 1.05 * (estimate.value - estimate.low));
}

TEST(Bootstrap, HoldsTheMeanOfASkewDistributionNineteenTimesOfTwenty) {
  const double held = coverage(8, [](Rng& rng) {
    std::vector<double> values;
    for (int i = 0; i < 100; ++i) {
      values.push_back(-std::log(1.0 - rng.uniform()));
    }
    return holds(
        bootstrap(
            100, [&](const auto& chosen) { return mean_at(values, chosen); }, 1000, rng.next_u32()),
        1.0);
  });
  RecordProperty("coverage", std::to_string(held));
  EXPECT_GT(held, 0.93);
  EXPECT_LT(held, 0.97);
}

TEST(Bootstrap, HoldsARatioOfMediansNineteenTimesOfTwenty) {
  const double held = coverage(9, [](Rng& rng) {
    std::vector<double> over;
    std::vector<double> under;
    for (int i = 0; i < 101; ++i) {
      over.push_back(std::exp(0.5 * rng.normal() + std::log(3.0)));  // median 3
      under.push_back(std::exp(0.3 * rng.normal()));                 // median 1
    }
    const auto ratio = [&](const auto& chosen) {
      return median_at(over, chosen) / median_at(under, chosen);
    };
    return holds(bootstrap(101, ratio, 500, rng.next_u32()), 3.0);
  });
  RecordProperty("coverage", std::to_string(held));
  EXPECT_GT(held, 0.93);
  EXPECT_LT(held, 0.97);
}

TEST(Jackknife, OfAMeanIsItsStandardError) {
  // Values 1, 2, 3, 6 have mean 3; without one each: 11/3, 10/3, 3, 2. The standard error of the
  // mean is sqrt(sum of (x - 3)^2 / (n (n - 1))) = sqrt(14 / 12).
  const std::vector<double> without_one = {11.0 / 3.0, 10.0 / 3.0, 3.0, 2.0};
  EXPECT_NEAR(jackknife_error(without_one), std::sqrt(14.0 / 12.0), 1e-12);
}

}  // namespace
}  // namespace glint
