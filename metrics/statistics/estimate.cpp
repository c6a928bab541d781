// SPDX-License-Identifier: GPL-3.0-or-later
//
// Estimates with intervals: of shares (Wilson 1927), rates (Garwood 1936), means (Student 1908),
// and of anything by bias-corrected and accelerated bootstrap (B. Efron, "Better bootstrap
// confidence intervals", JASA 82, 1987). Resampling draws from a counter-based generator, so a seed
// gives the same interval for any number of threads. docs/theory/statistics.md. Cost: constant, or
// for the bootstrap one evaluation per resample and per observation.
#include "metrics/statistics/estimate.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/rng.h"
#include "metrics/statistics/quantiles.h"

namespace glint {
namespace {

double two_sided(double confidence) {
  GLINT_CHECK(confidence > 0.0 && confidence < 1.0, "a confidence lies in (0, 1)");
  return 0.5 * (1.0 + confidence);
}

/// Of sorted values: linear between ranks, the k-th of n at k / (n + 1).
double quantile_of(const std::vector<double>& sorted, double share) {
  const auto count = static_cast<double>(sorted.size());
  const double place = std::clamp(share * (count + 1.0) - 1.0, 0.0, count - 1.0);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double rest = place - static_cast<double>(below);
  return rest > 0.0 ? (1.0 - rest) * sorted[below] + rest * sorted[above] : sorted[below];
}

using Statistic = std::function<double(std::span<const std::size_t>)>;

std::vector<double> resampled(std::size_t n,
                              const Statistic& statistic,
                              int times,
                              std::uint64_t seed) {
  std::vector<double> values;
  std::vector<std::size_t> chosen(n);
  for (int i = 0; i < times; ++i) {
    Rng rng(seed, Stream::kResampling, static_cast<std::uint64_t>(i));
    for (std::size_t& index : chosen) {
      index = std::min(n - 1, static_cast<std::size_t>(rng.uniform() * static_cast<double>(n)));
    }
    values.push_back(statistic(chosen));
    GLINT_CHECK(!std::isnan(values.back()), "a figure of some of the things is not a number");
  }
  std::sort(values.begin(), values.end());
  return values;
}

/// Skewness of the leave-one-out figures over 6: how the spread changes with the truth.
double acceleration(std::size_t n, const Statistic& statistic) {
  std::vector<double> without;
  std::vector<std::size_t> rest(n - 1);
  double mean = 0.0;
  for (std::size_t left_out = 0; left_out < n; ++left_out) {
    for (std::size_t i = 0; i + 1 < n; ++i) {
      rest[i] = i < left_out ? i : i + 1;
    }
    without.push_back(statistic(rest));
    mean += without.back() / static_cast<double>(n);
  }
  double squares = 0.0;
  double cubes = 0.0;
  for (const double value : without) {
    const double deviation = mean - value;
    squares += deviation * deviation;
    cubes += deviation * deviation * deviation;
  }
  return squares > 0.0 ? cubes / (6.0 * squares * std::sqrt(squares)) : 0.0;
}

/// Normal quantile of the share of resampled figures below the figure itself.
double median_bias(const std::vector<double>& sorted, double value) {
  const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), value);
  const auto below = static_cast<double>(first - sorted.begin());
  const auto equal = static_cast<double>(last - first);
  const auto count = static_cast<double>(sorted.size());
  const double share = (below + 0.5 * equal) / count;
  return normal_quantile(std::clamp(share, 0.5 / count, 1.0 - 0.5 / count));
}

}  // namespace

Estimate wilson(std::int64_t hits, std::int64_t trials, double confidence) {
  GLINT_CHECK(trials >= 1 && hits >= 0 && hits <= trials, "hits lie between 0 and trials");
  const double z = normal_quantile(two_sided(confidence));
  const auto n = static_cast<double>(trials);
  const double share = static_cast<double>(hits) / n;
  const double scale = 1.0 / (1.0 + z * z / n);
  const double centre = scale * (share + 0.5 * z * z / n);
  const double half = scale * z * std::sqrt((share * (1.0 - share) + 0.25 * z * z / n) / n);
  return {.value = share,
          .low = hits == 0 ? 0.0 : std::max(0.0, centre - half),
          .high = hits == trials ? 1.0 : std::min(1.0, centre + half)};
}

Estimate poisson_rate(std::int64_t events, double trials, double confidence) {
  GLINT_CHECK(events >= 0 && trials > 0.0, "events are counted in a positive number of trials");
  const double upper = two_sided(confidence);
  const auto count = static_cast<double>(events);
  return {.value = count / trials,
          .low = events == 0 ? 0.0 : gamma_quantile(1.0 - upper, count) / trials,
          .high = gamma_quantile(upper, count + 1.0) / trials};
}

Estimate mean_of(std::span<const double> values, double confidence) {
  GLINT_CHECK(values.size() >= 2, "the spread of a single value is not known");
  const auto n = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values) {
    mean += value;
  }
  mean /= n;
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - mean) * (value - mean);
  }
  const double half =
      t_quantile(two_sided(confidence), n - 1.0) * std::sqrt(squares / (n - 1.0) / n);
  return {.value = mean, .low = mean - half, .high = mean + half};
}

Estimate bootstrap(std::size_t n,
                   const Statistic& statistic,
                   int resamples,
                   std::uint64_t seed,
                   double confidence) {
  GLINT_CHECK(n >= 2 && resamples >= 100, "at least two things and a hundred resamples");
  std::vector<std::size_t> all(n);
  for (std::size_t i = 0; i < n; ++i) {
    all[i] = i;
  }
  const double value = statistic(all);
  const std::vector<double> sorted = resampled(n, statistic, resamples, seed);
  const double bias = median_bias(sorted, value);
  const double bend = acceleration(n, statistic);
  const double z = normal_quantile(two_sided(confidence));
  const auto end = [&](double side) {
    const double from = bias + side;
    const double slope = std::max(1.0 - bend * from, 1e-3);
    return quantile_of(sorted, normal_cdf(bias + from / slope));
  };
  return {.value = value, .low = end(-z), .high = end(z)};
}

double jackknife_error(std::span<const double> without_one) {
  const auto count = static_cast<double>(without_one.size());
  double mean = 0.0;
  for (const double value : without_one) {
    mean += value / count;
  }
  double squares = 0.0;
  for (const double value : without_one) {
    squares += (value - mean) * (value - mean);
  }
  return std::sqrt((count - 1.0) / count * squares);
}

}  // namespace glint
