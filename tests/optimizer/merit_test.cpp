// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/merit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "tests/optimizer/problems.h"

namespace glint {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Goal homogeneity_goal() {
  return {.objective = {.name = "h"},
          .constraints = {{.name = "cnr", .min = 3.0}, {.name = "clipped", .max = 0.01}}};
}

Outcome scored(double h, double cnr, double clipped) {
  return {.scores = {{"h", h}, {"cnr", cnr}, {"clipped", clipped}}};
}

TEST(Violation, IsRelativeToTheLimit) {
  EXPECT_EQ(violation({.name = "cnr", .min = 3.0}, 3.0), 0.0);
  EXPECT_DOUBLE_EQ(violation({.name = "cnr", .min = 3.0}, 1.5), 0.5);  // (3 - 1.5) / 3
  EXPECT_DOUBLE_EQ(violation({.name = "c", .max = 0.01}, 0.03), 2.0);  // 0.02 / 0.01
  EXPECT_DOUBLE_EQ(violation({.name = "c", .max = 0.0}, 0.25), 0.25);  // limit 0: as it is
  EXPECT_DOUBLE_EQ(violation({.name = "c", .min = -2.0}, -3.0), 0.5);  // 1 / 2
  EXPECT_EQ(violation({.name = "c", .min = 1.0}, -kInfinity), 1e6);
  EXPECT_EQ(violation({.name = "c", .min = 1.0}, kInfinity), 0.0);
}

TEST(Violation, OfAGoalIsTheWeightedSum) {
  Goal goal = homogeneity_goal();
  goal.constraints[1].weight = 10.0;
  EXPECT_DOUBLE_EQ(violation(goal, scored(0.9, 1.5, 0.02).scores), 0.5 + 10.0 * 1.0);
  EXPECT_TRUE(is_feasible(goal, scored(0.9, 3.0, 0.01).scores));
  EXPECT_FALSE(is_feasible(goal, scored(0.9, 2.999, 0.01).scores));
}

TEST(IsBetter, PutsFeasibleFirstThenViolationThenObjective) {
  const Goal goal = homogeneity_goal();
  const Scores good = scored(0.9, 4, 0).scores;
  const Scores plain = scored(0.5, 4, 0).scores;
  const Scores near = scored(0.99, 2.9, 0).scores;
  const Scores far = scored(0.999, 1.0, 0).scores;
  EXPECT_TRUE(is_better(goal, good, plain));
  EXPECT_FALSE(is_better(goal, plain, good));
  EXPECT_FALSE(is_better(goal, good, good));
  EXPECT_TRUE(is_better(goal, plain, near));
  EXPECT_FALSE(is_better(goal, near, plain));
  EXPECT_TRUE(is_better(goal, near, far));
  const Goal minimised = {.objective = {.name = "h", .is_maximised = false}};
  EXPECT_TRUE(is_better(minimised, plain, good));
}

TEST(MeritFunction, NegatesTheObjectiveAndAddsTheHandWorkedPenalty) {
  MeritFunction merit(test::box(1, 0, 1), homogeneity_goal(), FailurePolicy::kWorst, 2);
  EXPECT_DOUBLE_EQ(merit.next({0.1}, scored(0.5, 4, 0)), -0.5);
  EXPECT_DOUBLE_EQ(merit.next({0.2}, scored(0.7, 4, 0)), -0.7);
  // The spread of the first two is 0.2, so the scale is 3 * 0.2 = 0.6 from now on.
  EXPECT_DOUBLE_EQ(merit.penalty_scale(), 0.6000000000000001);
  // Violations (3 - 2) / 3 and (0.03 - 0.01) / 0.01.
  EXPECT_NEAR(merit.next({0.3}, scored(5.0, 2.0, 0.03)),
              -5.0 + 0.6 * (std::log(4.0 / 3.0) + std::log(3.0)),
              1e-12);
  EXPECT_DOUBLE_EQ(merit.penalty_scale(), 0.6000000000000001);
}

TEST(MeritFunction, TellsFailuresTheNearestOrTheWorst) {
  const Goal goal = {.objective = {.name = "h", .is_maximised = false}};
  const Outcome failed = {.is_failed = true, .message = "no"};
  for (const FailurePolicy policy : {FailurePolicy::kNearest, FailurePolicy::kWorst}) {
    MeritFunction merit(test::box(2, 0, 10), goal, policy, 8);
    EXPECT_EQ(merit.next({5, 5}, failed), MeritFunction::kUnknownMerit);
    merit.next({1, 1}, {.scores = {{"h", 3.0}}});
    merit.next({9, 9}, {.scores = {{"h", 8.0}}});
    EXPECT_EQ(merit.next({2, 3}, failed), policy == FailurePolicy::kNearest ? 3.0 : 8.0);
  }
}

TEST(MeritFunction, IsFiniteForAnyJudgeableScores) {
  MeritFunction merit(test::box(1, 0, 1), homogeneity_goal(), FailurePolicy::kNearest, 4);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(3, Stream::kTest, i);
    const double scale = std::pow(10.0, rng.uniform(-300, 300));
    const double cnr = i % 5 == 0 ? -kInfinity : scale * rng.normal();
    ASSERT_TRUE(std::isfinite(merit.next({0.5}, scored(scale * rng.normal(), cnr, scale))));
  }
}

TEST(ProblemWith, NamesWhatCannotBeJudged) {
  const Goal goal = homogeneity_goal();
  EXPECT_EQ(problem_with(goal, scored(1, kInfinity, 0).scores), "");
  EXPECT_EQ(problem_with(goal, scored(kInfinity, 1, 0).scores), "score \"h\" is infinite");
  EXPECT_EQ(problem_with(goal, scored(1, std::nan(""), 0).scores), "score \"cnr\" is NaN");
  EXPECT_EQ(problem_with(goal, {{"h", 1.0}, {"cnr", 1.0}}), "there is no score \"clipped\"");
}

TEST(Goal, RefusesWrongConstraints) {
  const auto message = [](const Goal& goal) -> std::string {
    try {
      check(goal);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  using testing::HasSubstr;
  EXPECT_EQ(message(homogeneity_goal()), "");
  EXPECT_THAT(message({}), HasSubstr("objective"));
  EXPECT_THAT(message({.objective = {"h"}, .constraints = {{.name = "a"}}}), HasSubstr("min, max"));
  EXPECT_THAT(message({.objective = {"h"}, .constraints = {{.name = "a", .min = 2, .max = 1}}}),
              HasSubstr("min 2 is above max 1"));
  EXPECT_THAT(message({.objective = {"h"}, .constraints = {{.name = "a", .min = 2, .weight = 0}}}),
              HasSubstr("weight"));
}

}  // namespace
}  // namespace glint
