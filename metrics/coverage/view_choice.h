// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which k of n views see most: greedily, or the best there are.
//
// Greedy takes one after the other the view that adds most; it reaches at least 1 - 1 / e of the
// best, in practice nearly all of it. Exact is branch and bound: views are taken in descending
// order of what they add, and a branch ends when what it has with the largest of what each
// remaining view would add to it by itself does not exceed the best so far, as no set of views adds
// more than its members one by one. Points that are seen by the same views are joined first.
//
// Sources: G. Nemhauser, L. Wolsey and M. Fisher, "An analysis of approximations for maximizing
// submodular set functions", Mathematical Programming 14, 1978 (greedy's share, the bound);
// docs/theory/coverage.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "metrics/coverage/visibility.h"

namespace glint {

struct ViewChoice {
  std::vector<std::size_t> views;  ///< in the order in which greedy would take them
  double share = 0.0;              ///< of the weights, seen by at least one of them
  bool is_proven = false;          ///< no other choice of as many views sees more
  std::int64_t nodes = 0;          ///< that branch and bound has looked at
};

/// @param count    of views to choose, >= 1; all of them when there are no more
/// @param weights  one a point, as coverage_of()
/// @throws ConfigError for count < 1, or weights as coverage_of()
ViewChoice choose_greedy(const Visibility& visibility, std::span<const double> weights, int count);

/// @param max_nodes  >= 1; when branch and bound needs more, the best so far is returned and
///                   is_proven is false
/// @throws ConfigError as choose_greedy()
ViewChoice choose_exact(const Visibility& visibility,
                        std::span<const double> weights,
                        int count,
                        std::int64_t max_nodes = 20'000'000);

}  // namespace glint
