// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well a number separates two groups: the receiver operating characteristic, its area with
// DeLong's variance from placements (DeLong et al. 1988) and an interval on the logit scale (Pepe
// 2003), and where that variance is zero a score interval (Newcombe 2006). Sorting both groups
// turns every count into a binary search. docs/theory/statistics.md. Cost: n log n; memory for the
// sorted numbers.
#include "metrics/statistics/roc.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "metrics/statistics/quantiles.h"

namespace glint {
namespace {

std::vector<double> sorted(std::span<const double> values) {
  GLINT_CHECK(!values.empty(), "figures of things with and of things without are needed");
  for (const double value : values) {
    GLINT_CHECK(!std::isnan(value), "a figure is not a number");
  }
  std::vector<double> result(values.begin(), values.end());
  std::sort(result.begin(), result.end());
  return result;
}

/// Share of the others below a figure, equal ones counted half.
double placement(double statistic, const std::vector<double>& others) {
  const auto [first, last] = std::equal_range(others.begin(), others.end(), statistic);
  const double below = static_cast<double>(first - others.begin());
  return (below + 0.5 * static_cast<double>(last - first)) / static_cast<double>(others.size());
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;  ///< over n - 1; 0 for one value
};

Moments placements(const std::vector<double>& values_of_group, const std::vector<double>& others) {
  std::vector<double> places;
  Moments moments;
  for (const double statistic : values_of_group) {
    places.push_back(placement(statistic, others));
    moments.mean += places.back();
  }
  moments.mean /= static_cast<double>(values_of_group.size());
  for (const double place : places) {
    moments.variance += (place - moments.mean) * (place - moments.mean);
  }
  moments.variance /= std::max(static_cast<double>(values_of_group.size()) - 1.0, 1.0);
  return moments;
}

/// Hanley and McNeil's variance of an area as Newcombe (2006, method 5) evens it out.
double variance_at(double area, double with, double without) {
  const double more = 0.5 * (with + without) - 1.0;
  const double factor = 1.0 + more * ((1.0 - area) / (2.0 - area) + area / (1.0 + area));
  return area * (1.0 - area) * factor / (with * without);
}

/// The area farthest from the measured one, towards `end`, that does not contradict it.
double farthest(double area, double end, double z, double with, double without) {
  double inside = area;
  double outside = end;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (inside + outside);
    const double reach = z * std::sqrt(variance_at(middle, with, without));
    (std::abs(middle - area) <= reach ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace

Estimate area_under_roc(std::span<const double> with,
                        std::span<const double> without,
                        double confidence) {
  const std::vector<double> hits = sorted(with);
  const std::vector<double> alarms = sorted(without);
  const Moments of_hits = placements(hits, alarms);
  const Moments of_alarms = placements(alarms, hits);
  const auto m = static_cast<double>(hits.size());
  const auto n = static_cast<double>(alarms.size());
  const double z = normal_quantile(0.5 * (1.0 + confidence));
  const double area = of_hits.mean;
  const double variance = of_hits.variance / m + of_alarms.variance / n;
  const double slack = area * (1.0 - area);
  constexpr double kRounding = 1e-24;
  if (!(variance > kRounding) || !(slack > 0.0)) {
    return {
        .value = area, .low = farthest(area, 0.0, z, m, n), .high = farthest(area, 1.0, z, m, n)};
  }
  const double centre = std::log(area / (1.0 - area));
  const double half = z * std::sqrt(variance) / slack;
  return {.value = area, .low = logistic(centre - half), .high = logistic(centre + half)};
}

}  // namespace glint
