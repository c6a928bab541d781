// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/merit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/rng.h"
#include "tests/optimizer/algorithm/problems.h"

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
  EXPECT_DOUBLE_EQ(merit.next({0.1}, scored(0.5, 4, 0)).merit, -0.5);
  EXPECT_DOUBLE_EQ(merit.next({0.2}, scored(0.7, 4, 0)).merit, -0.7);
  // The spread of the first two is 0.2, so the scale is 3 * 0.2 = 0.6 from now on.
  EXPECT_DOUBLE_EQ(merit.penalty_scale(), 0.6000000000000001);
  // Violations (3 - 2) / 3 and (0.03 - 0.01) / 0.01.
  EXPECT_NEAR(merit.next({0.3}, scored(5.0, 2.0, 0.03)).merit,
              -5.0 + 0.6 * (std::log(4.0 / 3.0) + std::log(3.0)),
              1e-12);
  EXPECT_DOUBLE_EQ(merit.penalty_scale(), 0.6000000000000001);
}

TEST(MeritFunction, TellsFailuresTheNearestOrTheWorst) {
  const Goal goal = {.objective = {.name = "h", .is_maximised = false}};
  const Outcome failed = {.is_failed = true, .message = "no"};
  for (const FailurePolicy policy : {FailurePolicy::kNearest, FailurePolicy::kWorst}) {
    MeritFunction merit(test::box(2, 0, 10), goal, policy, 8);
    EXPECT_EQ(merit.next({5, 5}, failed).merit, MeritFunction::kUnknownMerit);
    merit.next({1, 1}, {.scores = {{"h", 3.0}}});
    merit.next({9, 9}, {.scores = {{"h", 8.0}}});
    EXPECT_EQ(merit.next({2, 3}, failed).merit, policy == FailurePolicy::kNearest ? 3.0 : 8.0);
  }
}

TEST(MeritFunction, IsFiniteForAnyJudgeableScores) {
  MeritFunction merit(test::box(1, 0, 1), homogeneity_goal(), FailurePolicy::kNearest, 4);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(3, Stream::kTest, i);
    const double scale = std::pow(10.0, rng.uniform(-300, 300));
    const double cnr = i % 5 == 0 ? -kInfinity : scale * rng.normal();
    ASSERT_TRUE(std::isfinite(merit.next({0.5}, scored(scale * rng.normal(), cnr, scale)).merit));
  }
}

/// Smooth scores of the five continuous and two discrete variables, with exact gradients.
Outcome wavy(const Point& p) {
  const double wave = std::sin(p[0]) + std::log(p[1]) * std::log(p[1]) + 0.01 * p[2] + p[5] / 7.0;
  const double wave_1 = 2.0 * std::log(p[1]) / p[1];
  const double unknown = std::nan("");
  const double tilt = p[0] * std::log(p[1]) + 0.05 * p[2];
  return {.scores = {{"h", wave + p[4]}, {"cnr", 3.0 + tilt}, {"clipped", 0.02 * std::cos(p[0])}},
          .gradients = {{"h", {std::cos(p[0]), wave_1, 0.01, unknown, unknown, 1.0 / 7.0, unknown}},
                        {"cnr", {std::log(p[1]), p[0] / p[1], 0.05, 0, 0, 0, 0}},
                        {"clipped", {-0.02 * std::sin(p[0]), 0, 0, 0, 0, 0, 0}}}};
}

/// (f(u + d) - f(u - d)) / 2 d of what pick() takes from the answers.
template <class Pick>
double central_difference(const SearchSpace& space,
                          const MeritFunction& merit,
                          const std::vector<double>& unit,
                          std::size_t i,
                          const Pick& pick) {
  constexpr double kDelta = 1e-6;
  double values[2];
  for (const int side : {0, 1}) {
    std::vector<double> moved = unit;
    moved[i] += side == 0 ? -kDelta : kDelta;
    const Point point = point_from_unit(space, moved);
    values[side] = pick(MeritFunction(merit).next(point, wavy(point)));
  }
  return (values[1] - values[0]) / (2.0 * kDelta);
}

void expect_derivative(double derivative, double difference) {
  EXPECT_NEAR(derivative, difference, 1e-6 * (1.0 + std::abs(derivative)));
}

TEST(MeritFunction, GradientsAreThoseOfCentralDifferences) {
  const SearchSpace space = test::smooth_mixed_space();
  for (const bool is_maximised : {true, false}) {
    Goal goal = homogeneity_goal();
    goal.objective.is_maximised = is_maximised;
    goal.constraints[1].weight = 2.5;
    goal.constraints.push_back({.name = "cnr", .max = 6.0});
    MeritFunction merit(space, goal, FailurePolicy::kWorst, 2);
    const Point middle = point_from_unit(space, std::vector<double>(7, 0.5));
    const Point corner = point_from_unit(space, std::vector<double>(7, 0.1));
    merit.next(middle, wavy(middle));
    merit.next(corner, wavy(corner));
    for (std::uint64_t n = 0; n < 1000; ++n) {
      Rng rng(6, Stream::kTest, n);
      std::vector<double> unit(7);
      for (double& value : unit) {
        value = rng.uniform(0.01, 0.99);
      }
      const Point point = point_from_unit(space, unit);
      const Answer answer = MeritFunction(merit).next(point, wavy(point));
      ASSERT_EQ(answer.limits.size(), static_cast<std::size_t>(num_limits(goal)));
      for (std::size_t i = 0; i < unit.size(); ++i) {
        if (!is_continuous(space.variables[i])) {
          ASSERT_EQ(answer.objective.gradient[i], 0.0);
          continue;
        }
        expect_derivative(answer.objective.gradient[i],
                          central_difference(space, merit, unit, i, [](const Answer& a) {
                            return a.objective.value;
                          }));
        for (std::size_t k = 0; k < answer.limits.size(); ++k) {
          expect_derivative(answer.limits[k].gradient[i],
                            central_difference(space, merit, unit, i, [k](const Answer& a) {
                              return a.limits[k].value;
                            }));
        }
      }
    }
  }
}

TEST(MeritFunction, TellsLimitsApartFromTheObjective) {
  const Goal goal = {
      .objective = {.name = "h"},
      .constraints = {{.name = "cnr", .min = 3.0, .max = 5.0}, {.name = "clipped", .max = 0.0}}};
  MeritFunction merit(test::box(1, 0, 2), goal, FailurePolicy::kWorst, 2);
  Outcome outcome = scored(0.5, 6.0, -0.25);
  outcome.gradients = {{"h", {0.5}}, {"cnr", {2.0}}};
  const Answer answer = merit.next({1.0}, outcome);
  EXPECT_EQ(num_limits(goal), 3);
  ASSERT_EQ(answer.limits.size(), 3U);
  const double margin = MeritFunction::kLimitMargin;
  EXPECT_DOUBLE_EQ(answer.objective.value, -0.5);
  EXPECT_EQ(answer.objective.gradient, std::vector<double>{-1.0});  // -0.5 over a range of 2
  EXPECT_DOUBLE_EQ(answer.limits[0].value, -1.0 + margin);          // (3 - 6) / 3
  EXPECT_DOUBLE_EQ(answer.limits[1].value, 0.2 + margin);           // (6 - 5) / 5
  EXPECT_DOUBLE_EQ(answer.limits[0].gradient[0], -4.0 / 3.0);       // -2 * 2 / 3
  EXPECT_DOUBLE_EQ(answer.limits[1].gradient[0], 0.8);              // 2 * 2 / 5
  EXPECT_DOUBLE_EQ(answer.limits[2].value, -0.25 + margin);
  EXPECT_EQ(answer.limits[2].gradient, std::vector<double>{0.0});  // not known, and it holds
  EXPECT_TRUE(answer.limit_errors.empty());
}

TEST(MeritFunction, TellsTheErrorsOfLimitsInTheUnitOfTheLimits) {
  const Goal goal = {
      .objective = {.name = "h"},
      .constraints = {{.name = "cnr", .min = 3.0, .max = 5.0}, {.name = "clipped", .max = 0.0}}};
  MeritFunction merit(test::box(1, 0, 2), goal, FailurePolicy::kWorst, 2);
  Outcome outcome = scored(0.5, 6.0, -0.25);
  outcome.scores["cnr.error"] = 0.3;
  const Answer answer = merit.next({1.0}, outcome);
  ASSERT_EQ(answer.limit_errors.size(), 3U);
  EXPECT_DOUBLE_EQ(answer.limit_errors[0], 0.1);   // of 3
  EXPECT_DOUBLE_EQ(answer.limit_errors[1], 0.06);  // of 5
  EXPECT_TRUE(std::isnan(answer.limit_errors[2]));
  EXPECT_TRUE(answer.errors.empty());
  outcome.scores["clipped.error"] = 0.02;
  EXPECT_DOUBLE_EQ(merit.next({1.0}, outcome).limit_errors[2], 0.02);  // limit 0: as it is
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

TEST(MeritFunction, TakesAQuarterOfAnIntervalForTheErrorThatIsNotTold) {
  const Goal goal = {.objective = {.name = "h"},
                     .constraints = {{.name = "cnr", .min = 4.0, .max = {}}}};
  Outcome outcome{.scores = {{"h", 0.8}, {"h.low", 0.7}, {"h.high", 0.9}, {"cnr", 5.0}}};
  outcome.scores["cnr.low"] = 4.2;
  outcome.scores["cnr.high"] = 5.8;
  const auto told = [&](bool takes_intervals) {
    return MeritFunction(test::box(1, 0, 1), goal, FailurePolicy::kWorst, 2, true, takes_intervals)
        .next({0.5}, outcome);
  };
  ASSERT_EQ(told(true).errors.size(), 1U);
  EXPECT_NEAR(told(true).errors[0], 0.05, 1e-12);
  ASSERT_EQ(told(true).limit_errors.size(), 1U);
  EXPECT_NEAR(told(true).limit_errors[0], 0.1, 1e-12);  // 0.4, in parts of the limit
  EXPECT_TRUE(told(false).errors.empty());
  EXPECT_TRUE(told(false).limit_errors.empty());
  outcome.scores["h.error"] = 0.01;
  EXPECT_DOUBLE_EQ(told(true).errors[0], 0.01);
}

Scores with_interval(double h, double low, double high) {
  return {{"h", h}, {"h.low", low}, {"h.high", high}, {"cnr", 4.0}, {"clipped", 0.0}};
}

TEST(ObjectiveNoise, IsHalfTheIntervalAndNoneWithoutOne) {
  const Objective h = {.name = "h"};
  EXPECT_DOUBLE_EQ(objective_noise(h, with_interval(0.8, 0.7, 0.86)), 0.08);  // (0.86 - 0.7) / 2
  EXPECT_DOUBLE_EQ(objective_noise({.name = "h.low"}, with_interval(0.8, 0.7, 0.86)), 0.08);
  EXPECT_EQ(objective_noise(h, {{"h", 0.8}}), 0.0);
  EXPECT_EQ(objective_noise(h, {{"h", 0.8}, {"h.low", 0.7}}), 0.0);
  EXPECT_EQ(objective_noise(h, with_interval(0.8, 0.7, kInfinity)), 0.0);
  EXPECT_DOUBLE_EQ(objective_noise(h, {{"h", 0.8}, {"h.error", 0.01}}), 0.02);
  Scores both = with_interval(0.8, 0.77, 0.83);  // hypot(0.03, 2 * 0.02)
  both["h.error"] = 0.02;
  EXPECT_NEAR(objective_noise(h, both), 0.05, 1e-12);
}

TEST(DifferenceNoise, AddsInSquares) {
  const Scores a = with_interval(0.5, 0.47, 0.53);  // 0.03
  const Scores b = with_interval(0.5, 0.46, 0.54);  // 0.04
  EXPECT_NEAR(difference_noise({.name = "h"}, a, b), 0.05, 1e-12);
}

TEST(IsSurelyBetter, AsksFeasibleDesignsForALeadBeyondTheNoise) {
  const Goal goal = homogeneity_goal();
  const Scores base = with_interval(0.80, 0.77, 0.83);
  EXPECT_FALSE(is_surely_better(goal, with_interval(0.849, 0.809, 0.889), base));  // 0.049 < 0.05
  EXPECT_TRUE(is_surely_better(goal, with_interval(0.851, 0.811, 0.891), base));   // 0.051 > 0.05
  EXPECT_FALSE(is_surely_better(goal, base, with_interval(0.9, 0.86, 0.94)));
  Scores infeasible = with_interval(0.99, 0.98, 1.0);
  infeasible["cnr"] = 1.0;
  EXPECT_TRUE(is_surely_better(goal, base, infeasible));
  EXPECT_FALSE(is_surely_better(goal, infeasible, base));
}

TEST(IsSurelyBetter, IsIsBetterWithoutIntervals) {
  const Goal goal = homogeneity_goal();
  Rng rng(5, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Scores a = scored(rng.uniform(), rng.uniform(0.0, 6.0), rng.uniform(0.0, 0.02)).scores;
    const Scores b = scored(rng.uniform(), rng.uniform(0.0, 6.0), rng.uniform(0.0, 0.02)).scores;
    EXPECT_EQ(is_surely_better(goal, a, b), is_better(goal, a, b));
  }
}

}  // namespace
}  // namespace glint
