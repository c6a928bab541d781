// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/coverage/coverage.h"

#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

/// Calls f(point) for each bit that is set, in ascending order.
template <class F>
void for_each_bit(std::span<const std::uint64_t> row, const F& f) {
  for (std::size_t w = 0; w < row.size(); ++w) {
    for (std::uint64_t word = row[w]; word != 0; word &= word - 1) {
      f(64 * w + static_cast<std::size_t>(std::countr_zero(word)));
    }
  }
}

}  // namespace

std::vector<std::int32_t> view_counts(const Visibility& visibility) {
  std::vector<std::int32_t> counts(visibility.num_points());
  for (std::size_t view = 0; view < visibility.num_views(); ++view) {
    for_each_bit(visibility.row(view), [&](std::size_t point) { ++counts[point]; });
  }
  return counts;
}

double checked_sum(std::span<const double> weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!(weights[i] >= 0.0) || !std::isfinite(weights[i])) {
      throw ConfigError(fmt::format("weight {} is {}, must be finite and >= 0", i, weights[i]));
    }
    sum += weights[i];
  }
  if (!(sum > 0.0)) {
    throw ConfigError("the weights of all points together are 0, must be > 0");
  }
  return sum;
}

std::vector<double> shares_of_counts(std::span<const std::int32_t> counts,
                                     std::span<const double> weights,
                                     int largest_k) {
  GLINT_CHECK(counts.size() == weights.size(), "one weight a point");
  GLINT_CHECK(largest_k >= 1, "C1 is the least that is asked for");
  const double whole = checked_sum(weights);
  std::vector<double> ck(static_cast<std::size_t>(largest_k));
  for (std::size_t i = 0; i < counts.size(); ++i) {
    for (std::size_t k = 0; k < ck.size() && counts[i] > static_cast<std::int32_t>(k); ++k) {
      ck[k] += weights[i];
    }
  }
  for (double& share : ck) {
    share /= whole;
  }
  return ck;
}

Coverage coverage_of(const Visibility& visibility, std::span<const double> weights, int largest_k) {
  GLINT_CHECK(visibility.num_points() == weights.size(), "one weight a point");
  const std::vector<std::int32_t> counts = view_counts(visibility);
  Coverage result = {.ck = shares_of_counts(counts, weights, largest_k)};
  const double whole = checked_sum(weights);
  std::vector<std::uint8_t> is_seen(weights.size());
  for (std::size_t view = 0; view < visibility.num_views(); ++view) {
    ViewShare& share = result.views.emplace_back();
    for_each_bit(visibility.row(view), [&](std::size_t point) {
      const double weight = weights[point] / whole;
      share.sees += weight;
      share.adds += is_seen[point] == 0 ? weight : 0.0;
      share.only += counts[point] == 1 ? weight : 0.0;
      is_seen[point] = 1;
    });
    result.redundancy += share.sees;
  }
  return result;
}

}  // namespace glint
