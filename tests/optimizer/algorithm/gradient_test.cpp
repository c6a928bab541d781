// SPDX-License-Identifier: GPL-3.0-or-later
//
// Searches with exact derivatives: optima known by hand, the chain rule, and what happens when a
// derivative is missing or wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/optimizer/algorithm/problems.h"

namespace glint {
namespace {

using test::box;
using testing::HasSubstr;

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A problem whose optimum is known.
struct Problem {
  SearchSpace space;
  Goal goal;
  Outcome (*evaluate)(const Point&) = nullptr;
  double optimum = 0.0;  ///< of the objective
};

Outcome banana(const Point& p) {
  const double valley = p[1] - p[0] * p[0];
  const double rest = 1.0 - p[0];
  return {.scores = {{"loss", 100.0 * valley * valley + rest * rest}},
          .gradients = {{"loss", {-400.0 * p[0] * valley - 2.0 * rest, 200.0 * valley}}}};
}

/// Minimum 0 at (1, 1), at the end of a bent valley.
Problem banana_problem() {
  return {.space = box(2, -2, 2),
          .goal = {.objective = {.name = "loss", .is_maximised = false}},
          .evaluate = banana,
          .optimum = 0.0};
}

Outcome bowl_and_sum(const Point& p) {
  const double a = p[0] - 2.0;
  const double b = p[1] - 1.0;
  return {.scores = {{"loss", a * a + 2.0 * b * b}, {"sum", p[0] + p[1]}},
          .gradients = {{"loss", {2.0 * a, 4.0 * b}}, {"sum", {1.0, 1.0}}}};
}

/// min (x - 2)^2 + 2 (y - 1)^2 where x + y <= 1: 2 (x - 2) = 4 (y - 1) = -m and x + y = 1 give
/// x = 2 - m / 2, y = 1 - m / 4, 3 - 3 m / 4 = 1, m = 8 / 3, so x = 2 / 3, y = 1 / 3 and the
/// minimum is (4 / 3)^2 + 2 (2 / 3)^2 = 24 / 9.
Problem cut_bowl_problem() {
  return {.space = box(2, -3, 3),
          .goal = {.objective = {.name = "loss", .is_maximised = false},
                   .constraints = {{.name = "sum", .max = 1.0}}},
          .evaluate = bowl_and_sum,
          .optimum = 24.0 / 9.0};
}

Outcome sum_in_ball(const Point& p) {
  Outcome outcome;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double weight = 1.0 + static_cast<double>(i);
    outcome.scores["sum"] += weight * p[i];
    outcome.scores["square"] += p[i] * p[i];
    outcome.gradients["sum"].push_back(weight);
    outcome.gradients["square"].push_back(2.0 * p[i]);
  }
  return outcome;
}

/// max x1 + 2 x2 + ... + 6 x6 where |x|^2 <= 1: the length of (1, ..., 6), sqrt(91).
Problem ball_problem() {
  return {.space = box(6, 0, 2),
          .goal = {.objective = {.name = "sum"}, .constraints = {{.name = "square", .max = 1.0}}},
          .evaluate = sum_in_ball,
          .optimum = std::sqrt(91.0)};
}

Outcome log_bowl(const Point& p) {
  const double a = std::log(p[0] / 3.0);
  const double b = p[1] - 1.0;
  return {.scores = {{"loss", a * a + b * b + 0.5 * a * b}},
          .gradients = {{"loss", {(2.0 * a + 0.5 * b) / p[0], 2.0 * b + 0.5 * a}}}};
}

/// Minimum 0 at (3, 1); quadratic in the logarithm of the first variable.
Problem log_problem() {
  return {.space = {{{.name = "period", .low = 0.1, .high = 100.0, .is_log = true},
                     {.name = "x", .low = -3.0, .high = 5.0}}},
          .goal = {.objective = {.name = "loss", .is_maximised = false}},
          .evaluate = log_bowl,
          .optimum = 0.0};
}

Outcome long_bowl(const Point& p) {
  Outcome outcome;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double weight = 1.0 + 3.0 * static_cast<double>(i);
    const double d = p[i] + 0.3 - 0.1 * static_cast<double>(i);
    outcome.scores["loss"] += weight * d * d;
    outcome.gradients["loss"].push_back(2.0 * weight * d);
  }
  return outcome;
}

/// Minimum 0 in ten dimensions, 28 times as steep in one direction as in another.
Problem long_bowl_problem() {
  return {.space = box(10, -1, 1),
          .goal = {.objective = {.name = "loss", .is_maximised = false}},
          .evaluate = long_bowl,
          .optimum = 0.0};
}

/// Evaluations until a feasible design is within the tolerance of the optimum; kNever: not within
/// the budget.
double evaluations_to(const Problem& problem,
                      const std::string& algorithm,
                      double tolerance,
                      const Evaluate& evaluate = {},
                      int budget = 400) {
  const TemporaryFolder folder;
  Storage storage = Storage::open(folder / "s.sqlite", test::identity());
  const double slack = problem.goal.objective.is_maximised ? -tolerance : tolerance;
  const SearchTask task = {.space = problem.space,
                           .settings = {.algorithm = algorithm},
                           .goal = problem.goal,
                           .budget = {.evaluations = budget, .target = problem.optimum + slack}};
  const Evaluate plain = [&problem](const Point& p, int) { return problem.evaluate(p); };
  const SearchResult result = run_search(task, storage, evaluate ? evaluate : plain);
  return result.termination == Termination::kTarget ? result.evaluations : kNever;
}

TEST(GradientSearch, FindsSmoothOptimaInAFractionOfTheEvaluations) {
  for (const Problem& problem : {banana_problem(), log_problem(), long_bowl_problem()}) {
    const double bobyqa = evaluations_to(problem, "bobyqa", 1e-6);
    const double sbplx = evaluations_to(problem, "sbplx", 1e-6);
    for (const char* algorithm : {"slsqp", "lbfgs"}) {
      const double found = evaluations_to(problem, algorithm, 1e-6);
      RecordProperty(algorithm, std::to_string(found));
      EXPECT_LE(found, 40.0) << algorithm;
      EXPECT_LE(found, 0.8 * bobyqa) << algorithm;
      EXPECT_LE(found, 0.25 * sbplx) << algorithm;
    }
  }
  // From the far side of its valley, BOBYQA needs ten times as many.
  EXPECT_LE(evaluations_to(banana_problem(), "slsqp", 1e-6),
            0.2 * evaluations_to(banana_problem(), "bobyqa", 1e-6));
}

/// Its models are separable, so bent valleys are not for it.
TEST(GradientSearch, MmaSolvesWhatIsNotABentValley) {
  for (const Problem& problem : {log_problem(), long_bowl_problem()}) {
    EXPECT_LE(evaluations_to(problem, "mma", 1e-6), 30.0);
    EXPECT_LE(evaluations_to(problem, "mma", 1e-6), 0.25 * evaluations_to(problem, "sbplx", 1e-6));
  }
}

TEST(GradientSearch, EndsInsideAnActiveLimit) {
  for (const Problem& problem : {cut_bowl_problem(), ball_problem()}) {
    for (const char* algorithm : {"slsqp", "mma"}) {
      const double found = evaluations_to(problem, algorithm, 1e-4);
      EXPECT_LE(found, 20.0) << algorithm;
      EXPECT_LE(found, 0.3 * evaluations_to(problem, "bobyqa", 1e-4)) << algorithm;
      EXPECT_LE(found, 0.3 * evaluations_to(problem, "sbplx", 1e-4)) << algorithm;
    }
  }
  // L-BFGS gets there through smooth penalties, which takes more.
  EXPECT_LE(evaluations_to(cut_bowl_problem(), "lbfgs", 1e-4), 150.0);
  EXPECT_LE(evaluations_to(ball_problem(), "lbfgs", 1e-4), 100.0);
}

TEST(GradientSearch, KeepsToBothLimitsOfABand) {
  Problem problem = cut_bowl_problem();
  problem.goal.constraints = {{.name = "sum", .min = 0.25, .max = 0.5}};
  // At x + y = 1 / 2: 3 - 3 m / 4 = 1 / 2, m = 10 / 3, (5 / 3)^2 + 2 (5 / 6)^2 = 150 / 36.
  problem.optimum = 150.0 / 36.0;
  EXPECT_LE(evaluations_to(problem, "slsqp", 1e-4), 20.0);
  problem.goal.constraints = {{.name = "sum", .min = 4.0}};
  // m = -4 / 3: (2 / 3)^2 + 2 (1 / 3)^2 = 6 / 9.
  problem.optimum = 6.0 / 9.0;
  EXPECT_LE(evaluations_to(problem, "slsqp", 1e-4), 20.0);
}

/// Scores may be shares, per cent or micrometres: the search does not depend on it.
TEST(GradientSearch, DoesNotDependOnTheScaleOfTheObjective) {
  for (const char* algorithm : {"slsqp", "mma", "lbfgs"}) {
    const double plain = evaluations_to(long_bowl_problem(), algorithm, 1e-5);
    for (const double scale : {1e-6, 1e6}) {
      const double scaled = evaluations_to(
          long_bowl_problem(), algorithm, scale * 1e-5, [scale](const Point& p, int) {
            Outcome outcome = long_bowl(p);
            outcome.scores["loss"] *= scale;
            for (double& derivative : outcome.gradients["loss"]) {
              derivative *= scale;
            }
            return outcome;
          });
      EXPECT_NEAR(scaled, plain, 3.0) << algorithm;
    }
  }
}

TEST(GradientSearch, AWrongGradientDoesNotConverge) {
  for (const Problem& problem : {banana_problem(), long_bowl_problem(), cut_bowl_problem()}) {
    for (const char* algorithm : {"slsqp", "mma", "lbfgs"}) {
      const double found =
          evaluations_to(problem, algorithm, 1e-4, [&problem](const Point& p, int) {
            Outcome outcome = problem.evaluate(p);
            for (auto& [name, gradient] : outcome.gradients) {
              for (double& derivative : gradient) {
                derivative = -derivative;
              }
            }
            return outcome;
          });
      EXPECT_EQ(found, kNever) << algorithm;
    }
  }
}

/// A wall runs along the valley, closer to it than the first step is long.
TEST(GradientSearch, StepsBackFromFailedEvaluations) {
  for (const char* algorithm : {"slsqp", "lbfgs"}) {
    int failures = 0;
    const double found =
        evaluations_to(banana_problem(), algorithm, 1e-4, [&failures](const Point& p, int) {
          if (p[1] < p[0] * p[0] - 0.3) {
            ++failures;
            throw Error("the tunnel meets the camera");
          }
          return banana(p);
        });
    EXPECT_GT(failures, 0) << algorithm;
    EXPECT_LE(found, 200.0) << algorithm;
  }
}

/// Limits out of reach, limits that contradict each other, a flat one, noise and failures: nothing
/// of it may stop or hang a search.
TEST(GradientSearch, SurvivesGoalsThatCannotBeReached) {
  for (const char* algorithm : {"slsqp", "mma", "lbfgs"}) {
    for (const int num_dimensions : {1, 2, 5}) {
      const TemporaryFolder folder;
      Storage storage = Storage::open(folder / "s.sqlite", test::identity());
      const SearchTask task = {.space = box(num_dimensions, 0, 1),
                               .settings = {.algorithm = algorithm, .batch = 2},
                               .goal = {.objective = {.name = "sum"},
                                        .constraints = {{.name = "square", .min = 1e3},
                                                        {.name = "sum", .max = -5.0},
                                                        {.name = "flat", .min = 1.0, .max = 1.0}}},
                               .budget = {.evaluations = 150}};
      const SearchResult result =
          run_search(task, storage, [](const Point& p, int trial) -> Outcome {
            if (trial % 7 == 2) {
              throw Error("every seventh fails");
            }
            Outcome outcome = sum_in_ball(p);
            outcome.scores["sum"] += test::noise(trial);
            outcome.scores["flat"] = 0.5;
            outcome.gradients["flat"].assign(p.size(), 0.0);
            return outcome;
          });
      EXPECT_EQ(result.evaluations, 150) << algorithm;
      EXPECT_FALSE(result.is_feasible);
      EXPECT_TRUE(result.warnings.empty()) << algorithm << ": " << result.warnings.front();
    }
  }
}

TEST(GradientSearch, GoesOnElsewhereWhenAStartFails) {
  for (const char* algorithm : {"slsqp", "mma", "lbfgs"}) {
    int failures = 0;
    const double found = evaluations_to(
        long_bowl_problem(), algorithm, 1e-6, [&failures](const Point& p, int trial) {
          if (trial <= 3) {
            ++failures;
            throw Error("not yet");
          }
          return long_bowl(p);
        });
    EXPECT_EQ(failures, 3);
    EXPECT_LE(found, 60.0) << algorithm;
  }
}

TEST(GradientSearch, FindsTheBestChoiceAndItsContinuousOptimum) {
  for (const char* algorithm : {"slsqp", "mma", "lbfgs"}) {
    // Shape "round", where knots is inactive at its middle 6: 0.1 * |6 - 4| = 0.2.
    const Problem problem = {.space = test::smooth_mixed_space(),
                             .goal = {.objective = {.name = "loss", .is_maximised = false}},
                             .optimum = 0.2};
    const double found = evaluations_to(problem, algorithm, 1e-3, [](const Point& p, int) {
      return Outcome{.scores = {{"loss", test::mixed_value(p)}},
                     .gradients = {{"loss", test::mixed_gradient(p)}}};
    });
    EXPECT_LE(found, 400.0) << algorithm;
  }
}

/// The first trial of a search in which the outcome's derivatives were changed.
Trial first_trial(const std::string& algorithm, const Evaluate& evaluate) {
  const TemporaryFolder folder;
  Problem problem = cut_bowl_problem();
  problem.goal.constraints.push_back({.name = "share", .max = 0.5});
  {
    Storage storage = Storage::open(folder / "s.sqlite", test::identity());
    run_search({.space = problem.space,
                .settings = {.algorithm = algorithm},
                .goal = problem.goal,
                .budget = {.evaluations = 1},
                .start_points = {{2.0, 1.5}}},  // sum 3.5, outside its limit of 1
               storage,
               evaluate);
  }
  return Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch).at(0);
}

TEST(GradientSearch, AMissingDerivativeIsAFailedTrialThatNamesIt) {
  const auto message = [](const std::string& algorithm, void (*change)(Outcome&)) {
    const Trial trial = first_trial(algorithm, [change](const Point& p, int) {
      Outcome outcome = bowl_and_sum(p);
      outcome.scores["share"] = 0.25;  // inside, so that no derivative is needed
      change(outcome);
      return outcome;
    });
    EXPECT_EQ(trial.outcome->is_failed, !trial.outcome->message.empty());
    return trial.outcome->message;
  };
  EXPECT_EQ(message("slsqp", [](Outcome&) {}), "");
  EXPECT_THAT(message("slsqp", [](Outcome& o) { o.gradients.clear(); }),
              HasSubstr("no derivative of loss by x0, x1, which slsqp needs"));
  EXPECT_THAT(message("mma", [](Outcome& o) { o.gradients["loss"][1] = std::nan(""); }),
              HasSubstr("no derivative of loss by x1, which mma needs"));
  EXPECT_THAT(message("lbfgs", [](Outcome& o) { o.gradients["sum"].pop_back(); }),
              HasSubstr("no derivative of sum by x0, x1"));
  EXPECT_THAT(message("slsqp", [](Outcome& o) { o.scores["share"] = 0.75; }),
              HasSubstr("no derivative of share by x0, x1"));
  EXPECT_EQ(message("bobyqa", [](Outcome& o) { o.gradients.clear(); }), "");
}

TEST(GradientSearch, KeepsTheRemarkThatExplainsAMissingDerivative) {
  const Trial trial = first_trial("slsqp", [](const Point& p, int) {
    Outcome outcome = bowl_and_sum(p);
    outcome.scores["share"] = 0.0;
    outcome.gradients.clear();
    outcome.remarks = {{.count = {}, .text = "edges of the slot move"}};
    return outcome;
  });
  EXPECT_THAT(trial.outcome->message, HasSubstr("(edges of the slot move)"));
}

TEST(GradientSearch, RecordsTheGradientsItWasGiven) {
  const Trial trial = first_trial("slsqp", [](const Point& p, int) {
    Outcome outcome = bowl_and_sum(p);
    outcome.scores["share"] = 0.0;
    outcome.gradients["nothing"] = {};
    return outcome;
  });
  // 2 (2 - 2) = 0, 4 (1.5 - 1) = 2.
  EXPECT_EQ(trial.outcome->gradients.at("loss"), (std::vector<double>{0.0, 2.0}));
  EXPECT_EQ(trial.outcome->gradients.size(), 2U);
}

}  // namespace
}  // namespace glint
