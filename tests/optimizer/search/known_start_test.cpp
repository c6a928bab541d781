// SPDX-License-Identifier: GPL-3.0-or-later
//
// Searches that begin with the trials of an earlier run, whose outcomes are known.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/optimizer/search/searching.h"

namespace glint::test {
namespace {

constexpr int kKnown = 20;

/// Twenty known designs: the second best comes first, the best last.
SearchTask task_with_known_start() {
  SearchTask task = {.space = box(1, 0, 1),
                     .settings = {.algorithm = "random"},
                     .goal = {.objective = {.name = "loss", .is_maximised = false}},
                     .budget = {.evaluations = 60},
                     .is_start_known = true};
  for (int k = 0; k < kKnown; ++k) {
    task.start_points.push_back({k == 0 ? 0.35 : k == kKnown - 1 ? 0.3 : 0.4 + 0.02 * k});
  }
  task.start_points.push_back(task.start_points[5]);  // a design that is known twice is one
  return task;
}

SearchResult search_from_known_start(const TemporaryFolder& folder, const SearchTask& task) {
  return search_into(folder, task, [](const Point& p, int) {
    return Outcome{.scores = {{"loss", std::abs(p[0] - 0.3)}}};
  });
}

// What an earlier run knows is no search without progress.
TEST(KnownStart, StallCountsFromAfterIt) {
  SearchTask task = task_with_known_start();
  task.budget.stall = 6;
  const TemporaryFolder folder;
  const SearchResult result = search_from_known_start(folder, task);
  EXPECT_EQ(result.termination, Termination::kStall);
  EXPECT_EQ(result.evaluations, kKnown + 6) << "nothing is better than the best";
  EXPECT_EQ(result.best->point, Point{0.3});
  // Start points that were not known are searched like others.
  task.is_start_known = false;
  const TemporaryFolder other;
  EXPECT_EQ(search_from_known_start(other, task).evaluations, 1 + 6);
}

// What ended a search is not in its log: the same folder goes on.
TEST(KnownStart, ATargetEndsNoSearchBeforeAllOfItIsTold) {
  SearchTask task = task_with_known_start();
  task.budget.target = 0.06;
  const TemporaryFolder folder;
  task.is_start_known = false;
  ASSERT_EQ(search_from_known_start(folder, task).evaluations, 1);
  task.is_start_known = true;
  const SearchResult result = search_from_known_start(folder, task);
  EXPECT_EQ(result.termination, Termination::kTarget);
  EXPECT_EQ(result.evaluations, kKnown);
  EXPECT_EQ(result.best->point, Point{0.3});
}

// The model is asked about all of the known designs, not only about those of the last batch.
TEST(KnownStart, ATargetUnderNoiseIsLookedAtWhenItEnds) {
  SearchTask task = task_with_known_start();
  task.settings = {.algorithm = "gp", .is_noisy = true};
  task.start_points[0] = {0.45};
  task.start_points[9] = {0.3};
  task.start_points[kKnown - 1] = {0.8};
  task.budget.target = 0.01;
  const TemporaryFolder folder;
  const SearchResult result = search_from_known_start(folder, task);
  EXPECT_EQ(result.termination, Termination::kTarget);
  EXPECT_LT(result.evaluations, kKnown + 4);
}

}  // namespace
}  // namespace glint::test
