// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well designs can be told apart by what a search minimises.
#include "studies/accuracy/search_figures.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/accuracy/ladder_trial.h"

namespace glint {
namespace {

constexpr const char* kScored = "homogeneity.h_rms";
constexpr const char* kLimited = "homogeneity.mean";

Goal limited_goal() {
  Goal goal;
  goal.objective = {.name = kScored, .is_maximised = true};
  goal.constraints = {{.name = kLimited, .max = 5.0}};
  return goal;
}

Scores design_of(double scored, double limited, double scored_error, double limited_error) {
  return {{kScored, scored},
          {std::string(kScored) + ".error", scored_error},
          {kLimited, limited},
          {std::string(kLimited) + ".error", limited_error}};
}

// Objectives from 4 to 10: a unit of penalty counts 18. At 10 +- 0.2 with a limit of 5 it is
// log(2.04) - log(1.96) = 0.04 wide, half of which counts 0.36. Far below the limit it counts
// nothing.
TEST(SearchFigureErrors, HaveTheNoiseOfLimits) {
  const std::vector<Scores> designs = {design_of(4.0, 1.0, 0.3, 0.2),
                                       design_of(10.0, 10.0, 0.3, 0.2)};
  const auto errors = search_figure_errors(limited_goal(), designs);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_NEAR(errors[0][0], 0.3, 1e-6);
  EXPECT_NEAR(errors[0][1], std::hypot(0.3, 9.0 * std::log(2.04 / 1.96)), 1e-6);
}

// At the limit itself noise counts on one side: 9 log(1.04).
TEST(SearchFigureErrors, OfADesignAtItsLimitAreHalfOfOneSide) {
  const std::vector<Scores> designs = {design_of(4.0, 1.0, 0.0, 0.0),
                                       design_of(10.0, 5.0, 0.0, 0.2)};
  EXPECT_NEAR(search_figure_errors(limited_goal(), designs)[0][1], 9.0 * std::log(1.04), 1e-4);
}

TEST(SearchFigureErrors, OfSeveralObjectivesHaveNoLimits) {
  Goal goal = limited_goal();
  goal.more_objectives = {{.name = kLimited}};
  const std::vector<Scores> designs = {design_of(4.0, 1.0, 0.3, 0.2),
                                       design_of(10.0, 10.0, 0.3, 0.2)};
  const auto errors = search_figure_errors(goal, designs);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_NEAR(errors[0][1], 0.3, 1e-6);
  EXPECT_NEAR(errors[1][1], 0.2, 1e-6);
}

/// A cheap step, a dearer one that is the top's equal, and the top, which search by "auto" among 12
/// designs with the scores 0 to 11.
LadderChoice chosen_with(
    const Goal& goal, const std::function<Scores(std::size_t step, std::size_t design)>& scores) {
  LadderTask task;
  task.goal = goal;
  task.wish.is_auto = true;
  for (const auto& [name, work] :
       {std::pair{"cheap", 1.0}, std::pair{"equal", 2.0}, std::pair{"top", 10.0}}) {
    task.steps.push_back({.name = name, .work = work});
  }
  return try_ladder(task, [&](std::size_t step, std::span<const std::size_t> candidates) {
    std::vector<std::optional<Scores>> found;
    for (const std::size_t candidate : candidates) {
      found.emplace_back(scores(step, candidate));
    }
    return found;
  });
}

// Of the two best the cheap step has the other one in front; the top tells them apart by 1e-9
// alone.
TEST(TryLadder, AutoTakesDesignsAsTiedThatDifferByRounding) {
  const auto with_gap = [](double gap) {
    return chosen_with(limited_goal(), [=](std::size_t step, std::size_t design) {
      const double truth = design == 11 ? 10.0 + gap : static_cast<double>(design);
      return design_of(step == 0 && design == 11 ? 10.0 - gap : truth, 0.0, 0.0, 0.0);
    });
  };
  EXPECT_EQ(with_gap(1e-9).step, 0U);
  EXPECT_EQ(with_gap(0.1).step, 1U);
}

// All designs lie at their limit. The cheap step has the best one a tenth of the limit beyond it,
// which costs 33 log(1.1) = 3.1 and puts it behind three others. With a standard error of 1 the top
// knows its penalty within 33 log(1.2) / 2 = 3.
TEST(TryLadder, AutoTakesDesignsAsTiedThatDifferByTheNoiseOfALimit) {
  const auto with_error = [](double error) {
    return chosen_with(limited_goal(), [=](std::size_t step, std::size_t design) {
      const double beyond = step == 0 && design == 11 ? 0.5 : 0.0;
      return design_of(static_cast<double>(design), 5.0 + beyond, 0.0, error);
    });
  };
  EXPECT_EQ(with_error(0.0).step, 1U);
  EXPECT_EQ(with_error(1.0).step, 0U);
}

}  // namespace
}  // namespace glint
