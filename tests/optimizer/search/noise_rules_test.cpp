// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where rules 6 take noise into account and earlier ones do not: what counts as a gain of
// hypervolume and as reaching a target, and what models know of intervals.
#include <cmath>

#include <gmock/gmock.h>
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

TEST(NoiseRules, AGainOfAnExactObjectiveIsComparedWithTheNoiseOfTheVolume) {
  EXPECT_EQ(end_of_narrowing(1e-6, kSearchRules), Termination::kStall);
  EXPECT_EQ(end_of_narrowing(1e-6, 5), Termination::kEvaluations) << "as runs did that began so";
  // Each step adds 0.3 of area; "dark" moved by 0.003 would add 0.003 x 31 at most.
  EXPECT_EQ(end_of_narrowing(0.3, kSearchRules), Termination::kEvaluations);
}

/// A hill of 5 with a known error, that `lucky` (0: none) shows as 8.
SearchResult search_for(double target, double error, int lucky, int rules) {
  const SearchTask task = {.space = test::box(2, 0, 1),
                           .settings = {.algorithm = "gp", .is_noisy = true, .rules = rules},
                           .goal = {.objective = {.name = "gain"}},
                           .budget = {.evaluations = 40, .target = target}};
  const TemporaryFolder folder;
  const auto evaluate = [=](const Point& p, int trial) {
    const double hill = 5.0 - 8.0 * (std::pow(p[0] - 0.3, 2) + std::pow(p[1] - 0.6, 2));
    return Outcome{.scores = {{"gain", trial == lucky ? 8.0 : hill}, {"gain.error", error}}};
  };
  return test::search_into(folder, task, evaluate);
}

TEST(NoiseRules, ATargetIsReachedByWhatIsExpectedAndNotByOneLuckyEvaluation) {
  const SearchResult unlucky = search_for(7.5, 3.0, 20, kSearchRules);
  EXPECT_EQ(unlucky.termination, Termination::kEvaluations);
  EXPECT_TRUE(unlucky.warnings.empty());
  const SearchResult earlier = search_for(7.5, 3.0, 20, 5);
  EXPECT_EQ(earlier.termination, Termination::kTarget);
  EXPECT_EQ(earlier.evaluations, 20);
  ASSERT_EQ(earlier.warnings.size(), 1U);
  EXPECT_THAT(earlier.warnings[0], testing::HasSubstr("was reached by an evaluation with noise"));
  const SearchResult true_one = search_for(4.5, 0.05, 0, kSearchRules);
  EXPECT_EQ(true_one.termination, Termination::kTarget);
  EXPECT_LT(true_one.evaluations, 40);
  EXPECT_TRUE(true_one.warnings.empty());
  EXPECT_GE(true_one.expected.at(true_one.best->number).front().mean, 4.5);
}

std::vector<Point> asked_with_interval(double half, int rules) {
  const SearchTask task = {.space = test::box(2, 0, 1),
                           .settings = {.algorithm = "gp", .rules = rules},
                           .goal = {.objective = {.name = "gain"}},
                           .budget = {.evaluations = 20}};
  const TemporaryFolder folder;
  test::search_into(folder, task, [half](const Point& p, int) {
    const double gain = -std::pow(p[0] - 0.3, 2) - std::pow(p[1] - 0.6, 2);
    return Outcome{
        .scores = {{"gain", gain}, {"gain.low", gain - half}, {"gain.high", gain + half}}};
  });
  std::vector<Point> points;
  for (const Trial& trial : Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch)) {
    points.push_back(trial.point);
  }
  return points;
}

TEST(NoiseRules, ModelsKnowIntervalsOfScoresWithoutErrors) {
  EXPECT_EQ(asked_with_interval(0.0, 5), asked_with_interval(0.2, 5));
  EXPECT_EQ(asked_with_interval(0.0, 5), asked_with_interval(0.0, kSearchRules));
  EXPECT_NE(asked_with_interval(0.0, kSearchRules), asked_with_interval(0.2, kSearchRules));
}

}  // namespace
}  // namespace glint
