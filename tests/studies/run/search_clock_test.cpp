// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/search_clock.h"

#include <gtest/gtest.h>

#include "studies/run/run_costs.h"

namespace glint {
namespace {

/// A search whose evaluations take so many CPU seconds each, the first so much more, in batches
/// that end at once; it stops where enough is known.
SearchClock clock_after(int most, int at_once, double each_s, double first_more_s = 0.0) {
  SearchClock clock(at_once);
  for (int count = 1; count <= most && !clock.is_long(); ++count) {
    const int batches = (count + at_once - 1) / at_once;
    const double lag_s = 0.001 * ((count - 1) % at_once);  // one is told after the other
    clock.note(count, first_more_s + each_s * batches * at_once + lag_s);
  }
  return clock;
}

TEST(SearchClock, KnowsEqualEvaluationsOfWhateverLength) {
  for (const int at_once : {1, 2, 4, 7}) {
    for (const double each_s : {0.01, 0.4, 3.0, 10.0, 100.0}) {
      const SearchClock clock = clock_after(48, at_once, each_s);
      EXPECT_NEAR(clock.mean_s(100), each_s, 0.1 * each_s) << at_once << " at once, " << each_s;
    }
  }
}

TEST(SearchClock, CountsTheColdStartOnce) {
  // 2 s before the first one ends, 0.1 s each: 12 s for a hundred.
  EXPECT_NEAR(clock_after(48, 2, 0.1, 2.0).mean_s(100), 0.12, 0.002);
}

TEST(SearchClock, GoesOnAsTheLaterHalf) {
  SearchClock clock(1);
  double spent_s = 0.0;
  for (int count = 1; count <= 40; ++count) {
    spent_s += count <= 20 ? 0.1 : 0.2;
    clock.note(count, spent_s);
  }
  EXPECT_NEAR(clock.mean_s(40), 6.0 / 40, 1e-12);
  EXPECT_NEAR(clock.mean_s(100), (6.0 + 60 * 0.2) / 100, 1e-12);
}

TEST(SearchClock, OfNothingAndOfOneEvaluation) {
  EXPECT_EQ(SearchClock(2).mean_s(10), 0.0);
  SearchClock clock(4);
  clock.note(1, 3.0);
  EXPECT_NEAR(clock.mean_s(1), 3.0, 1e-12);
  EXPECT_NEAR(clock.mean_s(10), 3.0, 1e-12);
}

// 300 evaluations of 2 s, two at once, take 300 s of the clock and 600 CPU seconds.
TEST(PredictedSearch, EndsAtTheLimitThatIsMetFirst) {
  const auto of = [](const Budget& budget) { return *predicted_search(budget, 2.0, 2); };
  EXPECT_EQ(of({.evaluations = 300}).cpu_s, 600.0);
  EXPECT_EQ(of({.evaluations = 300, .wall_clock_s = 301.0}).cpu_s, 600.0);
  EXPECT_EQ(of({.evaluations = 300, .wall_clock_s = 301.0}).evaluations, 300);
  EXPECT_EQ(of({.evaluations = 300, .wall_clock_s = 100.0}).cpu_s, 200.0);
  EXPECT_EQ(of({.evaluations = 300, .wall_clock_s = 100.0}).evaluations, 100);
  EXPECT_EQ(of({.evaluations = 0, .wall_clock_s = 100.0}).evaluations, 100);
  EXPECT_TRUE(of({.evaluations = 300, .wall_clock_s = 100.0}).is_timed);
  EXPECT_FALSE(of({.evaluations = 300, .wall_clock_s = 301.0}).is_timed);
  EXPECT_FALSE(predicted_search({.evaluations = 0, .stall = 20}, 2.0, 2));
  EXPECT_FALSE(predicted_search({.evaluations = 0, .target = 0.9}, 2.0, 2));
}

}  // namespace
}  // namespace glint
