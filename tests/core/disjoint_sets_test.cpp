// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/disjoint_sets.h"

#include <array>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace glint {
namespace {

using ::testing::ElementsAre;

std::vector<std::int32_t> roots(DisjointSets sets, std::int32_t count) {
  std::vector<std::int32_t> found;
  for (std::int32_t i = 0; i < count; ++i) {
    found.push_back(sets.find(i));
  }
  return found;
}

TEST(DisjointSets, StandAloneUntilTheyAreJoined) {
  EXPECT_THAT(roots(DisjointSets(3), 3), ElementsAre(0, 1, 2));
}

// {0, 5}, {1, 2, 4}, {3}
TEST(DisjointSets, AreKnownByTheirSmallestMemberInWhateverOrderTheyAreJoined) {
  using Pair = std::pair<std::int32_t, std::int32_t>;
  const std::array<Pair, 4> pairs = {Pair{4, 2}, Pair{2, 1}, Pair{5, 0}, Pair{1, 4}};
  DisjointSets forwards(6);
  DisjointSets backwards(6);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Pair& last = pairs[pairs.size() - 1 - i];
    forwards.join(pairs[i].first, pairs[i].second);
    backwards.join(last.second, last.first);
  }
  EXPECT_THAT(roots(forwards, 6), ElementsAre(0, 1, 1, 3, 1, 0));
  EXPECT_THAT(roots(backwards, 6), ElementsAre(0, 1, 1, 3, 1, 0));
}

TEST(DisjointSets, OfALongChainAreOne) {
  DisjointSets sets(1000);
  for (std::int32_t i = 999; i > 0; --i) {
    sets.join(i, i - 1);
  }
  EXPECT_EQ(sets.find(999), 0);
  EXPECT_EQ(sets.find(500), 0);
}

}  // namespace
}  // namespace glint
