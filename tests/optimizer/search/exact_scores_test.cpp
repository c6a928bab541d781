// SPDX-License-Identifier: GPL-3.0-or-later
//
// Searches that know some of their scores from the design alone.
#include "optimizer/problem/exact_scores.h"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "optimizer/algorithm/exact_values.h"
#include "optimizer/search/search.h"
#include "optimizer/storage/sqlite.h"
#include "tests/optimizer/algorithm/problems.h"
#include "tests/optimizer/search/searching.h"

namespace glint {
namespace {

using test::box;
using test::events_and_points;
using test::search_into;

/// What a light of boards costs: whole boards along two directions, 13 steps in all.
double boards(const Point& p) {
  return (std::floor(7.3 * p[0]) + std::floor(5.1 * p[1])) / 12.0;
}

/// Better the larger the light is, and the nearer the other two variables are to their middle.
double blur(const Point& p) {
  return std::pow(1.0 - p[0], 2) + std::pow(1.0 - p[1], 2) + std::pow(p[2] - 0.5, 2) +
         std::pow(p[3] - 0.5, 2);
}

Outcome boards_and_blur(const Point& p, int /*trial*/) {
  return {.scores = {{"boards", boards(p)}, {"blur", blur(p)}}};
}

SearchTask boards_task(bool is_exact, std::uint64_t seed, int evaluations = 40) {
  SearchTask task = {
      .space = box(4, 0, 1),
      .settings = {.seed = seed},
      .goal = {.objective = {.name = "boards", .is_maximised = false, .reference = 1.1},
               .constraints = {},
               .more_objectives = {{.name = "blur", .is_maximised = false, .reference = 2.5}}},
      .budget = {.evaluations = evaluations}};
  if (is_exact) {
    task.exact = {.names = {"boards"}, .at = [](const Point& p) {
                    return Scores{{"boards", boards(p)}};
                  }};
  }
  return task;
}

double volume_found(const SearchTask& task, const Evaluate& evaluate) {
  const TemporaryFolder folder;
  return search_into(folder, task, evaluate).trade_off->hypervolume;
}

TEST(ExactScores, AnExactObjectiveGivesMoreHypervolumeThanAModelledOne) {
  double exactly = 0.0;
  double modelled = 0.0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const double with = volume_found(boards_task(true, seed), boards_and_blur);
    const double without = volume_found(boards_task(false, seed), boards_and_blur);
    RecordProperty("exact_" + std::to_string(seed), std::to_string(with));
    RecordProperty("modelled_" + std::to_string(seed), std::to_string(without));
    EXPECT_GT(with, without) << seed;
    exactly += with;
    modelled += without;
  }
  EXPECT_GT(exactly, 1.005 * modelled);
}

TEST(ExactScores, FewCandidatesWithExactValuesAreStillBetterThanNone) {
  double exactly = 0.0;
  double modelled = 0.0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    SearchTask task = boards_task(true, seed);
    task.exact.max_candidates = 12;
    exactly += volume_found(task, boards_and_blur);
    modelled += volume_found(boards_task(false, seed), boards_and_blur);
  }
  RecordProperty("exact", std::to_string(exactly));
  RecordProperty("modelled", std::to_string(modelled));
  EXPECT_GT(exactly, modelled);
}

/// Asked of so few candidates of a question: the best of 12, then six climbs.
TEST(ExactScores, AreAskedOfNoMoreCandidatesThanAllowed) {
  SearchTask task = boards_task(true, 1, 40);
  int calls = 0;
  const auto at = task.exact.at;
  task.exact.at = [&](const Point& p) {
    ++calls;
    return at(p);
  };
  task.exact.max_candidates = 12;
  const TemporaryFolder folder;
  search_into(folder, task, boards_and_blur);
  const int questions = 40 - design_size(task.space, task.settings);
  EXPECT_GT(calls, 6 * questions);
  EXPECT_LE(calls, (12 + 6) * questions);
}

/// The limit cuts off all but a thin slice, which the models of the first designs do not know.
TEST(ExactScores, AnExactLimitIsKeptByEveryDesignThatIsAskedAfterTheFirst) {
  SearchTask task = {.space = box(3, 0, 1),
                     .settings = {.algorithm = "gp"},
                     .goal = {.objective = {.name = "far", .is_maximised = true},
                              .constraints = {{.name = "ripple", .max = 0.2}}},
                     .budget = {.evaluations = 40}};
  const auto ripple = [](const Point& p) { return std::abs(std::sin(9.0 * p[0]) * p[1]); };
  const Evaluate evaluate = [&](const Point& p, int) {
    return Outcome{.scores = {{"far", p[0] + p[1] + p[2]}, {"ripple", ripple(p)}}};
  };
  const auto num_outside = [&](const SearchTask& given) {
    const TemporaryFolder folder;
    search_into(folder, given, evaluate);
    int count = 0;
    for (const Trial& trial : Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch)) {
      const bool is_asked = trial.number > design_size(given.space, given.settings);
      count += is_asked && trial.outcome->scores.at("ripple") > 0.2 ? 1 : 0;
    }
    return count;
  };
  EXPECT_GT(num_outside(task), 3);
  task.exact = {.names = {"ripple"}, .at = [&](const Point& p) {
                  return Scores{{"ripple", ripple(p)}};
                }};
  EXPECT_EQ(num_outside(task), 0);
}

TEST(ExactScores, ACutUpSearchIsTheSameBitForBit) {
  SearchTask task = boards_task(true, 2, 45);
  task.settings.batch = 3;
  task.exact.max_candidates = 12;
  task.goal.constraints = {{.name = "boards", .max = 0.95}};
  const Evaluate evaluate = [](const Point& p, int trial) {
    if (trial % 13 == 5) {
      throw Error("some fail");
    }
    return boards_and_blur(p, trial);
  };
  const TemporaryFolder whole;
  search_into(whole, task, evaluate);
  test::expect_resumed_as(whole, task, evaluate, {14, 23, 38, 45});
}

/// A search that began without knowing exact scores goes on as it began.
TEST(ExactScores, ARunByRules1Or2GoesOnWithoutThem) {
  for (const int rules : {1, 2}) {
    SearchTask earlier = boards_task(false, 1, 30);
    earlier.settings.rules = rules;
    const TemporaryFolder whole;
    search_into(whole, earlier, boards_and_blur);
    const TemporaryFolder begun;
    earlier.budget.evaluations = 18;
    search_into(begun, earlier, boards_and_blur);
    const SearchTask now = boards_task(true, 1, 30);
    ASSERT_EQ(now.settings.rules, kSearchRules);
    search_into(begun, now, boards_and_blur);
    EXPECT_EQ(events_and_points(begun), events_and_points(whole)) << rules;
    const TemporaryFolder fresh;
    search_into(fresh, now, boards_and_blur);
    EXPECT_NE(events_and_points(fresh), events_and_points(whole)) << rules;
  }
}

/// Nothing that is exact: rules 3 ask what rules 2 asked.
TEST(ExactScores, WithoutAnyRules3AskAsRules2) {
  const auto points = [](int rules) {
    SearchTask task = boards_task(false, 3, 30);
    task.settings.rules = rules;
    const TemporaryFolder folder;
    search_into(folder, task, boards_and_blur);
    std::vector<Point> asked;
    for (const Trial& trial : Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch)) {
      asked.push_back(trial.point);
    }
    return asked;
  };
  EXPECT_EQ(points(2), points(3));
}

TEST(ExactValues, AreObjectivesAndLimitsAsAlgorithmsAreToldThem) {
  const Goal goal = {
      .objective = {.name = "seen", .is_maximised = true},
      .constraints = {{.name = "width", .min = 10.0, .max = 40.0}, {.name = "clipped", .max = 0.5}},
      .more_objectives = {{.name = "width", .is_maximised = true}}};
  const ExactValues values(goal, {.names = {"width", "leds"}, .at = [](const Point& p) {
                                    if (p[0] > 1.0) {
                                      throw Error("too wide to be built");
                                    }
                                    return Scores{{"width", 50.0 * p[0]}, {"leds", 3.0}};
                                  }});
  EXPECT_EQ(values.is_exact(), (std::vector<bool>{false, true, true, true, false}));
  const std::vector<double> at = values.at({0.5});
  ASSERT_EQ(at.size(), 5U);
  EXPECT_TRUE(std::isnan(at[0]));
  EXPECT_DOUBLE_EQ(at[1], -25.0);
  EXPECT_NEAR(at[2], (10.0 - 25.0) / 10.0, 2e-6);  // of min, as a part of it, with its margin
  EXPECT_NEAR(at[3], (25.0 - 40.0) / 40.0, 2e-6);
  EXPECT_TRUE(std::isnan(at[4]));
  for (const double value : values.at({2.0})) {
    EXPECT_TRUE(std::isnan(value));
  }
  EXPECT_TRUE(ExactValues(goal, {.names = {"leds"}}).empty());
}

/// Where no light shines there is no size: nothing is known of a design that will fail.
TEST(ExactValues, AreNotKnownOfADesignThatHasNotAllOfThem) {
  const Goal goal = {.objective = {.name = "width", .is_maximised = false},
                     .constraints = {{.name = "frames", .max = 8.0}}};
  const ExactValues values(goal, {.names = {"width", "frames"}, .at = [](const Point& p) {
                                    Scores scores = {{"frames", 4.0}};
                                    if (p[0] > 0.0) {
                                      scores["width"] = p[0];
                                    }
                                    return scores;
                                  }});
  EXPECT_DOUBLE_EQ(values.at({0.5})[0], 0.5);
  for (const double value : values.at({0.0})) {
    EXPECT_TRUE(std::isnan(value));
  }
}

}  // namespace
}  // namespace glint
