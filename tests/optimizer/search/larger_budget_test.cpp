// SPDX-License-Identifier: GPL-3.0-or-later
//
// A raised budget gives the bits of the larger budget from the start.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "tests/optimizer/search/searching.h"

namespace glint {
namespace {

SearchTask task_in(SearchSpace space, std::string_view algorithm, int batch) {
  SearchTask task = {.space = std::move(space),
                     .settings = {.algorithm = std::string(algorithm), .batch = batch},
                     .goal = {.objective = {.name = "loss", .is_maximised = false}}};
  if (needs_several_objectives(algorithm)) {
    task.goal.more_objectives = {{.name = "length", .is_maximised = true}};
  }
  return task;
}

Outcome noisy_valley(const Point& p, int trial) {
  Outcome outcome = {.scores = {{"loss", test::noise(trial)}, {"length", p[0]}}};
  for (const double x : p) {
    outcome.scores["loss"] += (x - 0.3) * (x - 0.3);
    outcome.gradients["loss"].push_back(2.0 * (x - 0.3));
  }
  return outcome;
}

/// The same bits in one run as in one whose budget was raised again and again.
void expect_same_in_parts(SearchTask task,
                          const Evaluate& evaluate,
                          const std::vector<int>& budgets) {
  task.budget.evaluations = budgets.back();
  const TemporaryFolder at_once;
  const SearchResult expected = test::search_into(at_once, task, evaluate);
  EXPECT_EQ(expected.evaluations, budgets.back()) << task.settings.algorithm;
  const TemporaryFolder in_parts;
  for (const int evaluations : budgets) {
    task.budget.evaluations = evaluations;
    const SearchResult part = test::search_into(in_parts, task, evaluate);
    EXPECT_EQ(part.evaluations, evaluations) << task.settings.algorithm;
  }
  EXPECT_EQ(test::events_and_points(at_once), test::events_and_points(in_parts))
      << task.settings.algorithm;
}

TEST(RunSearch, ALargerBudgetLaterIsTheSameAsOneAtOnce) {
  for (const std::string_view algorithm : algorithm_names()) {
    expect_same_in_parts(task_in(test::box(4, 0, 1), algorithm, 4), noisy_valley, {1, 30, 55, 101});
  }
}

Outcome failing_now_and_then(const Point& p, int trial) {
  if (trial % 11 == 4) {
    throw Error("every eleventh fails");
  }
  return {.scores = {{"loss", test::mixed_value(p) + test::noise(trial)}, {"length", p[0]}},
          .gradients = {{"loss", test::mixed_gradient(p)},
                        {"length", {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}}}};
}

/// Choices, integers, conditions, a limit and failures; past the Sobol design, of at most 64.
TEST(RunSearch, ALargerBudgetLaterIsTheSameInAMixedSpace) {
  for (const std::string_view algorithm : algorithm_names()) {
    SearchTask task = task_in(test::mixed_space_for(algorithm), algorithm, 2);
    task.goal.constraints = {{.name = "length", .max = 0.8}};
    expect_same_in_parts(task, failing_now_and_then, {1, 40, 85, 121});
  }
}

}  // namespace
}  // namespace glint
