// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/ranking.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

constexpr double kMinDifference = 0.02;  ///< differences of one view below this share are none
constexpr double kInterval = 1.96;

using Values = std::map<std::string, double>;

std::vector<double> differences(const Values& first, const Values& second, double sign) {
  std::vector<double> list;
  for (const auto& [view, value] : first) {
    if (const auto found = second.find(view); found != second.end()) {
      list.push_back(sign * (value - found->second));
    }
  }
  return list;
}

Estimate difference(const Values& first, const Values& second, double sign, double error) {
  const std::vector<double> list = differences(first, second, sign);
  if (list.size() >= 3) {
    return mean_of(list);
  }
  const double a = mean_of_views(first);
  const double b = mean_of_views(second);
  const double sigma =
      std::max(error / std::sqrt(std::max<double>(1.0, static_cast<double>(list.size()))),
               kMinDifference * 0.5 * (std::abs(a) + std::abs(b)) / kInterval);
  const double value = sign * (a - b);
  return {.value = value, .low = value - kInterval * sigma, .high = value + kInterval * sigma};
}

bool holds_zero(const Estimate& estimate) {
  return estimate.low <= 0.0 && estimate.high >= 0.0;
}

std::vector<std::string> order_of(const std::vector<RankedDesign>& designs,
                                  Values RankedDesign::*side,
                                  double sign) {
  std::vector<const RankedDesign*> sorted;
  for (const RankedDesign& design : designs) {
    sorted.push_back(&design);
  }
  std::ranges::stable_sort(sorted, [&](const RankedDesign* a, const RankedDesign* b) {
    return sign * mean_of_views(a->*side) > sign * mean_of_views(b->*side);
  });
  std::vector<std::string> names;
  for (const RankedDesign* design : sorted) {
    names.push_back(design->name);
  }
  return names;
}

}  // namespace

double mean_of_views(const Values& values) {
  double sum = 0.0;
  for (const auto& [view, value] : values) {
    sum += value;
  }
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

Ranking rank_designs(const std::vector<RankedDesign>& designs, bool is_maximised) {
  const double sign = is_maximised ? 1.0 : -1.0;
  Ranking ranking = {.simulated = order_of(designs, &RankedDesign::simulated, sign),
                     .real = order_of(designs, &RankedDesign::real, sign)};
  for (std::size_t i = 0; i < designs.size(); ++i) {
    for (std::size_t k = i + 1; k < designs.size(); ++k) {
      const RankedDesign& a = designs[i];
      const RankedDesign& b = designs[k];
      const double error = std::hypot(a.simulated_error, b.simulated_error);
      RankedPair pair = {.first = a.name,
                         .second = b.name,
                         .simulated = difference(a.simulated, b.simulated, sign, error),
                         .real = difference(a.real, b.real, sign, error)};
      pair.is_level = holds_zero(pair.simulated) || holds_zero(pair.real);
      pair.is_against = !pair.is_level && pair.simulated.value * pair.real.value < 0.0;
      ranking.agrees = ranking.agrees && !pair.is_against;
      ranking.pairs.push_back(std::move(pair));
    }
  }
  return ranking;
}

}  // namespace glint
