// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/index.h"

namespace glint {

/// Sets of 0, 1, ... that can be joined (union-find with path halving). The smallest member stands
/// for its set, so that nothing depends on the order in which sets are joined; boost::disjoint_sets
/// chooses by rank instead. Cost: nearly linear in the calls.
class DisjointSets {
 public:
  /// Each member by itself.
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::int32_t{0});
  }

  /// The smallest member of the set.
  std::int32_t find(std::int32_t member) {
    while (parent_[index(member)] != member) {
      parent_[index(member)] = parent_[index(parent_[index(member)])];
      member = parent_[index(member)];
    }
    return member;
  }

  void join(std::int32_t a, std::int32_t b) {
    const std::int32_t first = find(a);
    const std::int32_t second = find(b);
    parent_[index(std::max(first, second))] = std::min(first, second);
  }

 private:
  std::vector<std::int32_t> parent_;
};

}  // namespace glint
