// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of a surface a set of views inspects. Shares are of the sum of all weights, in [0, 1];
// docs/theory/coverage.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "metrics/coverage/visibility.h"

namespace glint {

/// What one view brings to a set.
struct ViewShare {
  double sees = 0.0;  ///< by itself
  double adds = 0.0;  ///< that none of the views before it sees; the sum over all views is C1
  double only = 0.0;  ///< that no other view of the set sees
};

struct Coverage {
  std::vector<double> ck;   ///< [k - 1]: seen by at least k views; ck[0] is C1
  double redundancy = 0.0;  ///< mean number of views
  std::vector<ViewShare> views;

  double c1() const { return ck.front(); }
};

/// How many views see each point.
std::vector<std::int32_t> view_counts(const Visibility& visibility);

/// @param weights  one a point, >= 0, their sum > 0: areas
/// @param largest_k  >= 1; as many numbers ck has
/// @throws ConfigError when a weight is negative or not finite, or all are 0
Coverage coverage_of(const Visibility& visibility, std::span<const double> weights, int largest_k);

/// ck of counts that are not those of view_counts(): of views that count only when they look from
/// directions far enough apart (separation.h).
/// @throws ConfigError as above
std::vector<double> shares_of_counts(std::span<const std::int32_t> counts,
                                     std::span<const double> weights,
                                     int largest_k);

/// The sum of weights. @throws ConfigError when one is negative or not finite, or all are 0
double checked_sum(std::span<const double> weights);

}  // namespace glint
