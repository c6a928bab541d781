// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers of electrons. P(Poisson(mean) <= k) falls as the mean grows: its values at the next means
// of a grid on both sides are bounds of it. Where they agree on the k that u leads to, which at a
// step of 1/32 they do in 97 of 100 cases, nothing has to be summed; kRounding covers how far the
// sums are from what they stand for. Cost: up to k comparisons. Memory: 600 kB, once.
#include "simulator/sensor/poisson_quantile.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>

namespace glint {
namespace {

constexpr int kBeyondAnyQuantile = 200;  // mean 30 and u < 1 - 2^-33 end below 75

constexpr int kStepsPerUnit = 32;
constexpr std::size_t kRows = static_cast<std::size_t>(kLargestTabledMean) * kStepsPerUnit + 1;
constexpr std::size_t kColumns = 80;
constexpr double kRounding = 1e-12;

/// P(Poisson(mean) <= k) for k = 0, 1, ...
using Cumulated = std::array<double, kColumns>;

Cumulated cumulated_at(double mean) {
  Cumulated row = {};
  double probability = std::exp(-mean);
  row[0] = probability;
  for (std::size_t k = 1; k < row.size(); ++k) {
    probability *= mean / static_cast<double>(k);
    row[k] = row[k - 1] + probability;
  }
  return row;
}

class Tables {
 public:
  Tables() : rows_(std::make_unique<std::array<Cumulated, kRows>>()) {
    for (std::size_t i = 0; i < kRows; ++i) {
      (*rows_)[i] = cumulated_at(static_cast<double>(i) / kStepsPerUnit);
    }
  }

  /// -1 where the bounds do not agree.
  int quantile(double mean, double u) const {
    const auto below = static_cast<std::size_t>(mean * kStepsPerUnit);
    if (below + 1 >= kRows) {
      return -1;
    }
    const Cumulated& at_least = (*rows_)[below + 1];
    const Cumulated& at_most = (*rows_)[below];
    std::size_t k = 0;
    while (k < kColumns && u > at_least[k] - kRounding) {
      ++k;
    }
    const bool is_known = k < kColumns && (k == 0 || u > at_most[k - 1] + kRounding);
    return is_known ? static_cast<int>(k) : -1;
  }

 private:
  std::unique_ptr<std::array<Cumulated, kRows>> rows_;
};

}  // namespace

int summed_poisson_quantile(double mean, double u) {
  double probability = std::exp(-mean);
  double cumulated = probability;
  int k = 0;
  while (u > cumulated && k < kBeyondAnyQuantile) {
    ++k;
    probability *= mean / k;
    cumulated += probability;
  }
  return k;
}

int poisson_quantile(double mean, double u) {
  if (u < 1.0 - mean - kRounding) {
    return 0;  // e^-mean >= 1 - mean
  }
  static const Tables tables;
  const int known = tables.quantile(mean, u);
  return known >= 0 ? known : summed_poisson_quantile(mean, u);
}

}  // namespace glint
