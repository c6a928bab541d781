// SPDX-License-Identifier: GPL-3.0-or-later
//
// When a search with noise ends: what counts as a gain of hypervolume.
#include <gtest/gtest.h>

#include "tests/optimizer/search/searching.h"

namespace glint {
namespace {

/// Designs of which each is narrower by `step`, which is exact, and sees the same within its error.
Termination end_of_narrowing(double step, int rules) {
  const SearchTask task = {
      .space = test::box(2, 0, 1),
      .settings = {.algorithm = "sobol", .rules = rules},
      .goal = {.objective = {.name = "width", .is_maximised = false, .reference = 2.0},
               .constraints = {},
               .more_objectives = {{.name = "dark", .is_maximised = false, .reference = 2.0}}},
      .budget = {.evaluations = 100, .stall = 30}};
  const TemporaryFolder folder;
  const auto narrowing = [step](const Point&, int trial) {
    return Outcome{.scores = {{"width", 1.0 - step * trial}, {"dark", 1.0}, {"dark.error", 0.001}}};
  };
  return test::search_into(folder, task, narrowing).termination;
}

TEST(NoisyBudget, AGainOfAnExactObjectiveIsComparedWithTheNoiseOfTheVolume) {
  EXPECT_EQ(end_of_narrowing(1e-6, kSearchRules), Termination::kStall);
  EXPECT_EQ(end_of_narrowing(1e-6, 5), Termination::kEvaluations) << "as runs did that began so";
  // Each step adds 0.3 of area; "dark" moved by 0.003 would add 0.003 x 31 at most.
  EXPECT_EQ(end_of_narrowing(0.3, kSearchRules), Termination::kEvaluations);
}

}  // namespace
}  // namespace glint
