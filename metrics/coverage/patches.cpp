// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points are joined along the links between them; a patch is known by its lowest point, so that
// ties are decided alike everywhere. Cost: nearly linear in the links. docs/theory/coverage.md
#include "metrics/coverage/patches.h"

#include "core/disjoint_sets.h"
#include "core/error.h"
#include "core/index.h"

namespace glint {
namespace {

/// The points that are in, joined along the links between them.
DisjointSets joined(std::span<const std::uint8_t> is_in,
                    std::span<const std::array<std::int32_t, 2>> links) {
  DisjointSets sets(is_in.size());
  for (const auto& [a, b] : links) {
    if (is_in[index(a)] != 0 && is_in[index(b)] != 0) {
      sets.join(a, b);
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
  const auto root = [&](std::size_t i) { return index(sets.find(static_cast<std::int32_t>(i))); };
  std::vector<double> sums(is_in.size());
  std::size_t best = is_in.size();
  for (std::size_t i = 0; i < is_in.size(); ++i) {
    if (is_in[i] != 0) {
      sums[root(i)] += weights[i];
    }
  }
  for (std::size_t i = 0; i < is_in.size(); ++i) {
    if (is_in[i] != 0 && root(i) == i && (best == is_in.size() || sums[i] > sums[best])) {
      best = i;
    }
  }
  SurfacePatch patch;
  for (std::size_t i = 0; best < is_in.size() && i < is_in.size(); ++i) {
    if (is_in[i] != 0 && root(i) == best) {
      patch.points.push_back(i);
    }
  }
  patch.weight = best < is_in.size() ? sums[best] : 0.0;
  return patch;
}

}  // namespace glint
