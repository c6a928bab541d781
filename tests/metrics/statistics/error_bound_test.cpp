// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/error_bound.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "metrics/statistics/quantiles.h"

namespace glint {
namespace {

// Shift 0 is Student's; the one-sided tolerance factor of 10 values, content and confidence 0.95,
// is 2.911 (Hahn and Meeker 1991, table A.12).
TEST(NoncentralT, IsThatOfTables) {
  EXPECT_NEAR(noncentral_t_quantile(0.975, 7.0, 0.0), t_quantile(0.975, 7.0), 1e-9);
  const double root = std::sqrt(10.0);
  EXPECT_NEAR(noncentral_t_quantile(0.95, 9.0, normal_quantile(0.95) * root) / root, 2.911, 5e-4);
}

// By quadrature of the normal distribution over the chi distribution, done apart.
TEST(NoncentralT, IsItsIntegral) {
  const double shift = normal_quantile(0.995);
  const double four = noncentral_t_quantile(0.99, 3.0, shift * 2.0) / 2.0;
  EXPECT_NEAR(four, 13.6177, 1e-3);
  const double root = std::sqrt(12.0);
  EXPECT_NEAR(noncentral_t_quantile(0.99, 11.0, shift * root) / root, 5.08816, 1e-4);
}

TEST(ErrorBound, OfEqualErrorsIsTheirBias) {
  const ErrorBound bound = error_bound(std::array{-0.25, -0.25, -0.25}, 0.99, 0.99);
  EXPECT_EQ(bound.bias, -0.25);
  EXPECT_EQ(bound.spread, 0.0);
  EXPECT_EQ(bound.bound, 0.25);
}

TEST(ErrorBound, FallsWithTheNumberOfErrorsAndRisesWithConfidence) {
  const std::vector<double> few = {-1.0, 1.0, -1.0, 1.0};
  std::vector<double> many;
  for (int i = 0; i < 50; ++i) {
    many.push_back(i % 2 == 0 ? -1.0 : 1.0);
  }
  EXPECT_LT(error_bound(many, 0.99, 0.99).bound, error_bound(few, 0.99, 0.99).bound);
  EXPECT_LT(error_bound(few, 0.99, 0.9).bound, error_bound(few, 0.99, 0.99).bound);
  EXPECT_GT(error_bound(many, 0.99, 0.5).bound, normal_quantile(0.995));
}

/// Share of errors of N(bias, 1) beyond a bound.
double share_beyond(double bound, double bias) {
  return normal_cdf(-bound - bias) + normal_cdf(bias - bound);
}

/// Share of experiments of n errors whose bound holds less than the content.
double share_of_failures(int n, double bias, double content, double confidence) {
  constexpr int kRepeats = 4000;
  int failures = 0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    Rng rng(7, Stream::kTest, static_cast<std::uint64_t>(repeat));
    std::vector<double> errors;
    for (int i = 0; i < n; ++i) {
      errors.push_back(bias + rng.normal());
    }
    failures += share_beyond(error_bound(errors, content, confidence).bound, bias) > 1.0 - content;
  }
  return failures / static_cast<double>(kRepeats);
}

// With a bias of several spreads one side alone matters: its content is (1 + content) / 2.
TEST(ErrorBound, HoldsAsOftenAsItPromises) {
  for (const int n : {4, 12, 40}) {
    for (const double bias : {0.0, 0.5, 3.0}) {
      EXPECT_LE(share_of_failures(n, bias, 0.99, 0.95), 0.06) << n << " errors, bias " << bias;
    }
  }
}

// The negative control: the plain quantile with the sample's spread fails far more often.
TEST(ErrorBound, IsNotThePlainQuantile) {
  int failures = 0;
  for (std::uint64_t repeat = 0; repeat < 1000; ++repeat) {
    Rng rng(8, Stream::kTest, repeat);
    const std::array errors = {rng.normal(), rng.normal(), rng.normal(), rng.normal()};
    const ErrorBound seen = error_bound(errors, 0.99, 0.95);
    const double plain = std::abs(seen.bias) + normal_quantile(0.995) * seen.spread;
    failures += share_beyond(plain, 0.0) > 0.01;
  }
  EXPECT_GT(failures, 200);
}

// t(0.995, 11) = 3.1058 (tables), times sqrt(13 / 12).
TEST(PredictionFactor, IsThatOfTables) {
  EXPECT_NEAR(prediction_factor(12, 0.99), 3.1058 * std::sqrt(13.0 / 12.0), 2e-4);
  EXPECT_NEAR(tolerance_factor(12, 0.99, 0.99), 5.08816, 1e-4);
}

// Of one more error, over many experiments: with 4000 of them the share has a standard error of
// 0.16 %. A bias only makes the bound wider.
TEST(PredictionFactor, HoldsAsOftenAsItPromises) {
  for (const int n : {4, 12}) {
    int beyond = 0;
    for (std::uint64_t repeat = 0; repeat < 4000; ++repeat) {
      Rng rng(9, Stream::kTest, repeat);
      std::vector<double> errors;
      for (int i = 0; i < n; ++i) {
        errors.push_back(rng.normal());
      }
      const ErrorBound seen = error_bound(errors, 0.99, 0.99);
      const double k = prediction_factor(errors.size(), 0.99);
      beyond += std::abs(rng.normal()) > std::abs(seen.bias) + k * seen.spread;
    }
    EXPECT_LE(beyond, 55) << n;
    EXPECT_GE(beyond, 10) << n << ": it is no wider than it needs to be";
  }
}

TEST(ErrorBoundDeathTest, RefusesWhatItCannotBound) {
  EXPECT_DEATH(error_bound(std::array{1.0}, 0.99, 0.99), "at least two errors");
  EXPECT_DEATH(error_bound(std::array{1.0, 2.0}, 1.0, 0.99), "content");
  EXPECT_DEATH(error_bound(std::array{1.0, 2.0}, 0.99, 1.0), "probability");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_DEATH(error_bound(std::array{1.0, nan}, 0.99, 0.99), "finite");
}

}  // namespace
}  // namespace glint
