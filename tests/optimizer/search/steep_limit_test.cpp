// SPDX-License-Identifier: GPL-3.0-or-later
//
// Limits whose scores grow by powers of ten beyond the border, and are all but constant within.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "optimizer/algorithm/exact_values.h"
#include "optimizer/algorithm/merit.h"
#include "tests/optimizer/search/searching.h"

namespace glint::test {
namespace {

/// Three numbers whose weighted sum is to be as large as their plain sum allows. The score of the
/// limit is 0.01 e^(10 b) - 0.0099 for a sum of 1.5 + b, so that b may be log(1.99) / 10.
SearchTask steep_task(std::uint64_t seed, int evaluations, int rules) {
  SearchTask task;
  task.space = box(3, 0.0, 1.0);
  task.goal = {.objective = {.name = "gain", .is_maximised = true},
               .constraints = {{.name = "clipped", .max = 0.01}}};
  task.settings = {.algorithm = "gp", .seed = seed, .rules = rules};
  task.budget.evaluations = evaluations;
  return task;
}

Outcome steep(const Point& x, int /*trial*/) {
  const double beyond = std::max(0.0, x[0] + x[1] + x[2] - 1.5);
  return {.scores = {{"gain", x[0] + 1.5 * x[1] + 2.0 * x[2]},
                     {"clipped", 0.01 * std::exp(10.0 * beyond) - 0.0099}}};
}

/// Of 1, 0.5 + b and 0 for the factors 2, 1.5 and 1.
const double kBest = 2.0 + 1.5 * (0.5 + 0.1 * std::log(1.99));

/// What the best feasible design of a search leaves, and how many designs are feasible.
struct Left {
  double gap = kBest;
  int num_feasible = 0;
};

Left left_by(int rules, std::uint64_t seed) {
  const SearchTask task = steep_task(seed, 30, rules);
  const TemporaryFolder folder;
  search_into(folder, task, steep);
  Left left;
  for (const Trial& trial : Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch)) {
    if (is_feasible(task.goal, trial.outcome->scores)) {
      ++left.num_feasible;
      left.gap = std::min(left.gap, kBest - trial.outcome->scores.at("gain"));
    }
  }
  return left;
}

/// By rules 3 the values far outside are all that the model of the limit sees.
TEST(SteepLimit, IsFoundByTheSignedLogarithm) {
  int num_missed_before = 0;
  for (std::uint64_t seed = 1; seed <= 7; ++seed) {
    const Left now = left_by(4, seed);
    EXPECT_LT(now.gap, 0.005) << seed;
    EXPECT_GE(now.num_feasible, 10) << seed;
    num_missed_before += left_by(3, seed).gap > 0.05 ? 1 : 0;
  }
  EXPECT_GE(num_missed_before, 4);
}

TEST(SteepLimit, ARunByRules3GoesOnByThem) {
  const TemporaryFolder whole;
  search_into(whole, steep_task(1, 24, 3), steep);
  const TemporaryFolder begun;
  search_into(begun, steep_task(1, 15, 3), steep);
  search_into(begun, steep_task(1, 24, kSearchRules), steep);
  EXPECT_EQ(events_and_points(begun), events_and_points(whole));
  const TemporaryFolder fresh;
  search_into(fresh, steep_task(1, 24, kSearchRules), steep);
  EXPECT_NE(events_and_points(fresh), events_and_points(whole));
}

/// The same with a limit that is known to a tenth of it.
Outcome steep_with_error(const Point& x, int trial) {
  Outcome outcome = steep(x, trial);
  outcome.scores["clipped.error"] = 0.001;
  return outcome;
}

/// Rules 5 differ from rules 4 by the errors of limits alone; a run by rules 4 goes on without.
TEST(SteepLimit, ErrorsOfLimitsAreKnownFromRules5On) {
  const auto asked = [](int rules, const Evaluate& evaluate) {
    const TemporaryFolder folder;
    search_into(folder, steep_task(1, 20, rules), evaluate);
    std::vector<Point> points;
    for (const Trial& trial : Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch)) {
      points.push_back(trial.point);
    }
    return points;
  };
  EXPECT_EQ(asked(4, steep), asked(5, steep));
  EXPECT_EQ(asked(4, steep), asked(4, steep_with_error));
  EXPECT_NE(asked(5, steep), asked(5, steep_with_error));
  const TemporaryFolder begun;
  search_into(begun, steep_task(1, 14, 4), steep_with_error);
  search_into(begun, steep_task(1, 20, kSearchRules), steep_with_error);
  std::vector<Point> points;
  for (const Trial& trial : Storage::read(begun / "s.sqlite").trials(TrialKind::kSearch)) {
    points.push_back(trial.point);
  }
  EXPECT_EQ(points, asked(4, steep_with_error));
}

TEST(SteepLimit, ASearchThatKnowsTheErrorIsResumedBitForBit) {
  const SearchTask task = steep_task(2, 24, kSearchRules);
  const TemporaryFolder whole;
  search_into(whole, task, steep_with_error);
  test::expect_resumed_as(whole, task, steep_with_error, {9, 15, 24});
}

TEST(LogLimit, KeepsSignAndDerivativeAtTheBorder) {
  EXPECT_EQ(log_limit(0.0), 0.0);
  EXPECT_DOUBLE_EQ(log_limit(std::exp(3.0) - 1.0), 3.0);
  EXPECT_DOUBLE_EQ(log_limit(1.0 - std::exp(2.0)), -2.0);
  for (const double value : {-5.0, -0.3, 0.2, 40.0}) {
    const double step = 1e-6 * (1.0 + std::abs(value));
    const double derivative = (log_limit(value + step) - log_limit(value - step)) / (2.0 * step);
    EXPECT_NEAR(log_limit_derivative(value), derivative, 1e-6);
  }
  EXPECT_EQ(log_limit_derivative(0.0), 1.0);
}

TEST(LogLimit, IsThatOfExactLimitsToo) {
  const Goal goal = {.objective = {.name = "width"},
                     .constraints = {{.name = "width", .min = 10.0, .max = 40.0}}};
  ExactValues values(goal, {.names = {"width"}, .at = [](const Point& point) {
                              return Scores{{"width", point[0]}};
                            }});
  const std::vector<double> plain = values.at({50.0});
  values.take_logs_of_limits();
  const std::vector<double> logs = values.at({50.0});
  EXPECT_EQ(logs[0], plain[0]);
  EXPECT_EQ(logs[1], log_limit(plain[1]));
  EXPECT_EQ(logs[2], log_limit(plain[2]));
  EXPECT_NEAR(plain[2], 0.25, 1e-5);
}

}  // namespace
}  // namespace glint::test
