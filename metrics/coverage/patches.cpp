// SPDX-License-Identifier: GPL-3.0-or-later
//
// Union by lowest point with path halving: a set is known by its lowest point, so that ties are
// decided alike everywhere. Cost: nearly linear in the links. docs/theory/coverage.md
#include "metrics/coverage/patches.h"

#include <algorithm>
#include <numeric>

#include "core/error.h"

namespace glint {
namespace {

/// Sets that are joined; each is known by its lowest point.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  std::size_t root(std::size_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }

  void join(std::size_t a, std::size_t b) {
    const std::size_t low = root(a);
    const std::size_t high = root(b);
    parent_[std::max(low, high)] = std::min(low, high);
  }

 private:
  std::vector<std::size_t> parent_;
};

/// The points that are in, joined along the links between them.
DisjointSets joined(std::span<const std::uint8_t> is_in,
                    std::span<const std::array<std::int32_t, 2>> links) {
  DisjointSets sets(is_in.size());
  for (const auto& [a, b] : links) {
    const auto i = static_cast<std::size_t>(a);
    const auto k = static_cast<std::size_t>(b);
    if (is_in[i] != 0 && is_in[k] != 0) {
      sets.join(i, k);
    }
  }
  return sets;
}

}  // namespace

SurfacePatch largest_patch(std::span<const std::uint8_t> is_in,
                           std::span<const double> weights,
                           std::span<const std::array<std::int32_t, 2>> links) {
  GLINT_CHECK(is_in.size() == weights.size(), "one weight a point");
  DisjointSets sets = joined(is_in, links);
  std::vector<double> sums(is_in.size());
  std::size_t best = is_in.size();
  for (std::size_t i = 0; i < is_in.size(); ++i) {
    if (is_in[i] != 0) {
      sums[sets.root(i)] += weights[i];
    }
  }
  for (std::size_t i = 0; i < is_in.size(); ++i) {
    if (is_in[i] != 0 && sets.root(i) == i && (best == is_in.size() || sums[i] > sums[best])) {
      best = i;
    }
  }
  SurfacePatch patch;
  for (std::size_t i = 0; best < is_in.size() && i < is_in.size(); ++i) {
    if (is_in[i] != 0 && sets.root(i) == best) {
      patch.points.push_back(i);
    }
  }
  patch.weight = best < is_in.size() ? sums[best] : 0.0;
  return patch;
}

}  // namespace glint
