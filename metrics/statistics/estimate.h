// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers with their intervals. Formulas and sources: docs/theory/statistics.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace glint {

/// A value and the interval that holds the truth with a stated confidence.
struct Estimate {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// A rate of hits, with Wilson's score interval. @param trials  >= 1
Estimate wilson(std::int64_t hits, std::int64_t trials, double confidence = 0.95);

/// Events per trial, with Garwood's exact interval. @param trials  > 0
Estimate poisson_rate(std::int64_t events, double trials, double confidence = 0.95);

/// The mean of independent values, with Student's interval. @param values  at least two
Estimate mean_of(std::span<const double> values, double confidence = 0.95);

/// Any figure of n things, with the bias-corrected and accelerated bootstrap interval (Efron 1987).
/// Asks for the figure 1 + resamples + n times. Below some 30 things it is too narrow.
/// @param n          >= 2
/// @param statistic     of the things at the given indices, each in [0, n); never NaN
/// @param resamples  >= 100
Estimate bootstrap(std::size_t n,
                   const std::function<double(std::span<const std::size_t>)>& statistic,
                   int resamples,
                   std::uint64_t seed,
                   double confidence = 0.95);

/// Standard error of a figure from its values without one batch each (delete-one jackknife):
/// sqrt((B - 1) / B sum of (value - mean)^2).
/// Source: B. Efron, C. Stein, "The jackknife estimate of variance", Annals of Statistics 9(3),
/// 1981.
/// @param without_one  two or more values
double jackknife_error(std::span<const double> without_one);

}  // namespace glint
