// SPDX-License-Identifier: GPL-3.0-or-later
//
// Searches by a Gaussian process that takes derivatives.
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "optimizer/search/search.h"
#include "tests/optimizer/algorithm/problems.h"
#include "tests/optimizer/search/searching.h"

namespace glint {
namespace {

using test::box;
using test::events_and_points;
using test::search_into;
using testing::HasSubstr;

/// A smooth valley in five variables and a limit that cuts off its floor.
Outcome valley(const Point& p, int /*trial*/) {
  Outcome outcome;
  double loss = 0.0;
  double sum = 0.0;
  std::vector<double> derivatives;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double x = p[i] - 0.35 - 0.05 * static_cast<double>(i);
    loss += x * x + 0.3 * std::sin(4.0 * x) * x;
    derivatives.push_back(2.0 * x + 0.3 * std::sin(4.0 * x) + 1.2 * std::cos(4.0 * x) * x);
    sum += p[i];
  }
  outcome.scores = {{"loss", loss}, {"sum", sum}};
  outcome.gradients = {{"loss", derivatives}, {"sum", std::vector<double>(p.size(), 1.0)}};
  return outcome;
}

SearchTask valley_task(bool derivatives, int evaluations) {
  return {.space = box(5, 0, 1),
          .settings = {.algorithm = "gp", .derivatives = derivatives},
          .goal = {.objective = {.name = "loss", .is_maximised = false},
                   .constraints = {{.name = "sum", .min = 2.4}}},
          .budget = {.evaluations = evaluations}};
}

double best_loss(const SearchTask& task, const Evaluate& evaluate) {
  const TemporaryFolder folder;
  const SearchResult result = search_into(folder, task, evaluate);
  return result.is_feasible ? result.best->outcome->scores.at("loss") : 1e9;
}

TEST(DerivativesSearch, ComesNearTheOptimumInFewEvaluations) {
  // The loss is the same function of p - 0.35 - 0.05 i in each variable and nearly a parabola
  // there, so on sum = 2.4 all five are 0.03 above 0: 5 (0.0009 + 0.009 sin 0.12) = 0.009887.
  constexpr double kOptimum = 5.0 * (0.0009 + 0.009 * 0.119712);
  const double with = best_loss(valley_task(true, 15), valley);
  const double without = best_loss(valley_task(false, 15), valley);
  RecordProperty("with", std::to_string(with));
  RecordProperty("without", std::to_string(without));
  EXPECT_LT(with, kOptimum + 0.01);
  EXPECT_GT(without, kOptimum + 0.03);
}

TEST(DerivativesSearch, ACutUpSearchIsTheSameBitForBit) {
  SearchTask task = valley_task(true, 36);
  task.settings.batch = 2;
  const Evaluate evaluate = [](const Point& p, int trial) {
    if (trial % 11 == 5) {
      throw Error("some fail");
    }
    Outcome outcome = valley(p, trial);
    if (trial % 7 == 3) {
      outcome.gradients.erase("sum");
    }
    if (trial == 16) {
      outcome.gradients.at("loss")[2] += 50.0;  // contradicts the others
    }
    return outcome;
  };
  const TemporaryFolder whole;
  search_into(whole, task, evaluate);
  test::expect_resumed_as(whole, task, evaluate, {7, 15, 24, 36});
  task.jobs = 2;
  const TemporaryFolder threaded;
  search_into(threaded, task, evaluate);
  EXPECT_EQ(events_and_points(threaded), events_and_points(whole));
}

TEST(DerivativesSearch, SaysWhichDerivativesItLetsGo) {
  const Evaluate evaluate = [](const Point& p, int trial) {
    Outcome outcome = valley(p, trial);
    if (trial == 9) {
      outcome.gradients.at("loss")[2] += 50.0;
    }
    return outcome;
  };
  const TemporaryFolder folder;
  const SearchResult result = search_into(folder, valley_task(true, 30), evaluate);
  EXPECT_THAT(result.warnings, testing::Contains(HasSubstr("contradict")));
}

TEST(DerivativesSearch, AStudyWithoutDerivativesIsToldSo) {
  const TemporaryFolder folder;
  const SearchResult result =
      search_into(folder, valley_task(true, 30), [](const Point& p, int trial) {
        Outcome outcome = valley(p, trial);
        outcome.gradients.clear();
        outcome.remarks = {{.text = "paths have none"}};
        return outcome;
      });
  EXPECT_EQ(result.termination, Termination::kFailures);
  const std::vector<Trial> trials = Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch);
  EXPECT_THAT(trials.front().outcome->message,
              HasSubstr("no derivative of loss, sum, which search.derivatives asks for"));
  EXPECT_THAT(trials.front().outcome->message, HasSubstr("paths have none"));
}

TEST(DerivativesSearch, OthersThanTheGaussianProcessRefuseThem) {
  const auto error_of = [](const SearchTask& task) -> std::string {
    const TemporaryFolder folder;
    try {
      search_into(folder, task, valley);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  SearchTask task = valley_task(true, 5);
  task.settings.algorithm = "slsqp";
  EXPECT_THAT(error_of(task), HasSubstr("not with slsqp, which takes derivatives in any case"));
  task.settings.algorithm = "bobyqa";
  EXPECT_THAT(error_of(task),
              HasSubstr("search.derivatives: is available only with auto or gp, not with bobyqa"));
  task.settings.algorithm = "auto";
  EXPECT_EQ(resolved_algorithm(task.space, task.settings), "gp");
  task.goal.more_objectives = {{.name = "sum"}};
  EXPECT_THAT(error_of(task), HasSubstr("works with a single objective only, there are 2"));
}

}  // namespace
}  // namespace glint
