// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/matched_filter.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/metrics/statistics/coverage.h"

namespace glint {
namespace {

constexpr double kNeighbour = 0.6;  // correlation of neighbours; of pixels k apart 0.6^k

/// Rows of a background whose every pixel has variance 4 and which is correlated along the row.
std::vector<std::vector<double>> correlated_windows(std::uint64_t seed, int count, int pixels) {
  std::vector<std::vector<double>> windows;
  for (int k = 0; k < count; ++k) {
    Rng rng(seed, Stream::kTest, static_cast<std::uint64_t>(k));
    std::vector<double> window = {rng.normal()};
    for (int i = 1; i < pixels; ++i) {
      window.push_back(kNeighbour * window.back() +
                       std::sqrt(1.0 - kNeighbour * kNeighbour) * rng.normal());
    }
    for (double& value : window) {
      value = 10.0 + 2.0 * value;
    }
    windows.push_back(window);
  }
  return windows;
}

std::vector<double> bump(int pixels) {
  std::vector<double> signal;
  for (int i = 0; i < pixels; ++i) {
    const double x = (i - 0.5 * (pixels - 1)) / 2.0;
    signal.push_back(3.0 * std::exp(-0.5 * x * x));
  }
  return signal;
}

/// The same closed form: the first pixel has variance 4, each other one 4 (1 - 0.36) about 0.6 of
/// its neighbour, so s^T K^-1 s is a sum over the row.
double true_dprime(const std::vector<double>& signal) {
  double sum = signal[0] * signal[0] / 4.0;
  for (std::size_t i = 1; i < signal.size(); ++i) {
    const double rest = signal[i] - kNeighbour * signal[i - 1];
    sum += rest * rest / (4.0 * (1.0 - kNeighbour * kNeighbour));
  }
  return std::sqrt(sum);
}

/// The closed form of white noise: |signal| / sigma.
double dprime_white(const std::vector<double>& signal, double sigma) {
  double squares = 0.0;
  for (const double value : signal) {
    squares += value * value;
  }
  return std::sqrt(squares) / sigma;
}

TEST(Dprime, OfTwoCorrelatedPixelsIsWorkedByHand) {
  // K = [[1, r], [r, 1]], K^-1 = [[1, -r], [-r, 1]] / (1 - r^2) with r = 0.6: s = (1, 1) has
  // 2 (1 - r) / (1 - r^2) = 2 / 1.6 = 1.25, s = (1, -1) has 2 / 0.4 = 5; variances of 4 quarter it.
  const auto windows = correlated_windows(1, 40000, 2);
  EXPECT_NEAR(dprime(std::array{1.0, 1.0}, windows) / std::sqrt(1.25 / 4.0), 1.0, 0.01);
  EXPECT_NEAR(dprime(std::array{1.0, -1.0}, windows) / std::sqrt(5.0 / 4.0), 1.0, 0.01);
}

// 60 windows: 20 times (1, 1) and (-1, -1), 10 times (1, -1) and (-1, 1). Variances 60 / 59,
// correlation 20 / 60 = 1 / 3. Its estimate's variance is (1 - 1 / 9) / 59 (Schaefer and Strimmer,
// w = x1 x2 is +-59 / 60), over its square: s = 8 / 59 is shrunk away. For (1, 1) the eigenvalue is
// 4 / 3: d'^2 = 2 (59 / 60) / ((1 - s) (4 / 3) / m + s). m = (58 - sum of (1 - s) l /
// ((1 - s) l + m s)) / 59 over l = 4 / 3 and 2 / 3 is 0.953970. d' = 1.209781.
TEST(Dprime, OfSixtyWindowsIsShrunkAsWorkedByHand) {
  std::vector<std::vector<double>> windows;
  for (int i = 0; i < 60; ++i) {
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    windows.push_back({sign, i < 40 ? sign : -sign});
  }
  EXPECT_NEAR(dprime(std::array{1.0, 1.0}, windows), 1.209781, 1e-6);
}

TEST(Dprime, OfManyCorrelatedPixelsIsTheClosedForm) {
  const std::vector<double> signal = bump(25);
  EXPECT_NEAR(dprime(signal, correlated_windows(2, 20000, 25)) / true_dprime(signal), 1.0, 0.01);
}

TEST(Dprime, OfWhiteNoiseIsTheNormOverSigma) {
  std::vector<std::vector<double>> windows;
  for (int k = 0; k < 20000; ++k) {
    Rng rng(3, Stream::kTest, static_cast<std::uint64_t>(k));
    std::vector<double>& window = windows.emplace_back();
    for (int i = 0; i < 16; ++i) {
      window.push_back(0.5 * rng.normal());
    }
  }
  const std::vector<double> signal = bump(16);
  EXPECT_NEAR(dprime(signal, windows) / dprime_white(signal, 0.5), 1.0, 0.01);
}

TEST(Dprime, OfFewWindowsIsNotTooHigh) {
  // The plain inverse of 60 windows of 25 pixels is too high by sqrt(59 / 33) = 1.34. What is left
  // is the shrinkage, which forgets some of the correlation that hides a smooth signal.
  const std::vector<double> signal = bump(25);
  double mean = 0.0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    mean += dprime(signal, correlated_windows(100 + i, 60, 25)) / 100.0;
  }
  EXPECT_NEAR(mean / true_dprime(signal), 1.0, 0.13);
}

TEST(Dprime, CanBeTakenWithFewerWindowsThanPixels) {
  const std::vector<double> signal = bump(25);
  const double value = dprime(signal, correlated_windows(5, 15, 25));
  EXPECT_GT(value, 0.5 * true_dprime(signal));
  EXPECT_LT(value, 2.0 * true_dprime(signal));
}

TEST(Dprime, GrowsWithTheSignalAndForgetsItsSign) {
  const auto windows = correlated_windows(6, 200, 9);
  std::vector<double> signal = bump(9);
  const double once = dprime(signal, windows);
  for (double& value : signal) {
    value *= -3.0;
  }
  EXPECT_NEAR(dprime(signal, windows), 3.0 * once, 1e-9);
}

TEST(Dprime, DoesNotDependOnTheUnitsOfSinglePixels) {
  auto windows = correlated_windows(7, 200, 9);
  std::vector<double> signal = bump(9);
  const double before = dprime(signal, windows);
  for (auto& window : windows) {
    window[4] *= 100.0;
  }
  signal[4] *= 100.0;
  EXPECT_NEAR(dprime(signal, windows), before, 1e-9);
}

TEST(Dprime, OfABackgroundThatNeverVariesIsInfiniteButForNoSignal) {
  const std::vector<std::vector<double>> still(5, std::vector<double>(3, 0.5));
  EXPECT_EQ(dprime(std::array{1.0, 0.0, 0.0}, still), std::numeric_limits<double>::infinity());
  EXPECT_EQ(dprime(std::array{0.0, 0.0, 0.0}, still), 0.0);
}

}  // namespace
}  // namespace glint
