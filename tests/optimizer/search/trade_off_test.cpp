// SPDX-License-Identifier: GPL-3.0-or-later
//
// Searches with several objectives, on problems whose front is known.
#include "optimizer/search/trade_off.h"

#include <cmath>
#include <ctime>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "optimizer/front/front.h"
#include "optimizer/search/search.h"
#include "optimizer/storage/sqlite.h"
#include "tests/optimizer/algorithm/problems.h"
#include "tests/optimizer/search/searching.h"

namespace glint {
namespace {

using test::box;
using test::events_and_points;
using test::search_into;
using testing::HasSubstr;

/// Minimises "f1" and "f2" in the unit cube.
SearchTask two_objectives(int num_dimensions, int evaluations) {
  return {.space = box(num_dimensions, 0, 1),
          .goal = {.objective = {.name = "f1", .is_maximised = false},
                   .constraints = {},
                   .more_objectives = {{.name = "f2", .is_maximised = false}}},
          .budget = {.evaluations = evaluations}};
}

/// ZDT1 (E. Zitzler, K. Deb and L. Thiele, Evolutionary Computation 8, 2000): on its front all
/// variables but the first are 0 and f2 = 1 - sqrt(f1). The area below the front is 1/3, so at the
/// reference (1.1, 1.1) the hypervolume is 1.21 - 1/3 = 0.8767.
Outcome zdt1(const Point& p, int /*trial*/) {
  double g = 1.0;
  for (std::size_t i = 1; i < p.size(); ++i) {
    g += 9.0 * p[i] / static_cast<double>(p.size() - 1);
  }
  return {.scores = {{"f1", p[0]}, {"f2", g * (1.0 - std::sqrt(p[0] / g))}}};
}

constexpr double kZdt1Volume = 1.21 - 1.0 / 3.0;

SearchTask zdt1_task(const std::string& algorithm, std::uint64_t seed) {
  SearchTask task = two_objectives(6, 60);
  task.settings.algorithm = algorithm;
  task.settings.seed = seed;
  task.goal.objective.reference = 1.1;
  task.goal.more_objectives[0].reference = 1.1;
  return task;
}

/// Squared distances from (0, 0.5, ..) and (1, 0.5, ..): on the front sqrt(f1) + sqrt(f2) = 1,
/// below which the area is 1/6, so at the reference (1.1, 1.1) the hypervolume is 1.21 - 1/6
/// = 1.0433.
Outcome two_bowls(const Point& p, int /*trial*/) {
  double f1 = p[0] * p[0];
  double f2 = (p[0] - 1.0) * (p[0] - 1.0);
  for (std::size_t i = 1; i < p.size(); ++i) {
    f1 += (p[i] - 0.5) * (p[i] - 0.5);
    f2 += (p[i] - 0.5) * (p[i] - 0.5);
  }
  return {.scores = {{"f1", f1}, {"f2", f2}}};
}

constexpr double kBowlsVolume = 1.21 - 1.0 / 6.0;

/// In four variables.
SearchTask bowls_task(const std::string& algorithm, std::uint64_t seed) {
  SearchTask task = zdt1_task(algorithm, seed);
  task.space = box(4, 0, 1);
  return task;
}

TEST(TradeOff, TheSearchComesNearTheKnownFrontAndBeyondRandomDesigns) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TemporaryFolder searched;
    const SearchResult found = search_into(searched, bowls_task("auto", seed), two_bowls);
    EXPECT_EQ(found.algorithm, "gp");
    const TemporaryFolder drawn;
    const SearchResult random = search_into(drawn, bowls_task("random", seed), two_bowls);
    RecordProperty("bowls_share_" + std::to_string(seed),
                   std::to_string(found.trade_off->hypervolume / kBowlsVolume));
    EXPECT_GT(found.trade_off->hypervolume, 0.98 * kBowlsVolume) << seed;
    EXPECT_LT(found.trade_off->hypervolume, kBowlsVolume);
    EXPECT_LT(random.trade_off->hypervolume, found.trade_off->hypervolume) << seed;
  }
}

TEST(TradeOff, TheSearchIsFarBeyondRandomDesignsOnZdt1) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TemporaryFolder searched;
    const SearchResult found = search_into(searched, zdt1_task("auto", seed), zdt1);
    const TemporaryFolder drawn;
    const SearchResult random = search_into(drawn, zdt1_task("random", seed), zdt1);
    RecordProperty("zdt1_share_" + std::to_string(seed),
                   std::to_string(found.trade_off->hypervolume / kZdt1Volume));
    EXPECT_GT(found.trade_off->hypervolume, 0.95 * kZdt1Volume) << seed;
    EXPECT_LT(found.trade_off->hypervolume, kZdt1Volume);
    EXPECT_LT(random.trade_off->hypervolume, 0.1 * kZdt1Volume) << seed;
  }
}

TEST(TradeOff, TheBestIsTheChosenDesignOfTheFront) {
  const TemporaryFolder folder;
  const SearchResult result = search_into(folder, bowls_task("auto", 1), two_bowls);
  const TradeOff& found = *result.trade_off;
  ASSERT_GE(found.trials.size(), 5U);
  EXPECT_EQ(result.best->number, found.trials[found.chosen]);
  EXPECT_THAT(found.reason, HasSubstr("nearest to the best of all objectives at once"));
  EXPECT_NEAR(result.best->point[0], 0.5, 0.15);  // halfway, as the front is symmetric
}

/// f1 = x and f2 = 1 - x: every design is on the front, in the unit square half of which it covers.
Outcome line(const Point& p, int /*trial*/) {
  return {.scores = {{"f1", p[0]}, {"f2", 1.0 - p[0]}}};
}

TEST(TradeOff, TheChoiceFollowsWeightsAndAspirations) {
  SearchTask task = two_objectives(1, 30);
  task.settings.algorithm = "sobol";
  task.goal.choice = ChoiceRule::kWeights;
  task.goal.objective.weight = 5.0;
  const TemporaryFolder weighted;
  const SearchResult cheap = search_into(weighted, task, line);
  EXPECT_LT(cheap.best->point[0], 0.1);  // f1 counts five times as much
  task.goal.choice = ChoiceRule::kAspirations;
  task.goal.objective.weight = 1.0;
  task.goal.more_objectives[0].aspiration = 0.1;
  const TemporaryFolder aspired;
  const SearchResult reached = search_into(aspired, task, line);
  EXPECT_LE(reached.best->outcome->scores.at("f2"), 0.1);
  EXPECT_THAT(reached.trade_off->reason, HasSubstr("reaches every aspiration"));
}

TEST(TradeOff, AnAbsentReferenceIsTheWorstOfTheInitialDesignAndStays) {
  SearchTask task = two_objectives(2, 40);
  task.goal.objective = {.name = "f1", .is_maximised = true};
  const TemporaryFolder folder;
  const SearchResult result = search_into(folder, task, [](const Point& p, int) {
    return Outcome{.scores = {{"f1", p[0]}, {"f2", p[1]}}};
  });
  const Storage storage = Storage::read(folder / "s.sqlite");
  const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
  const int num_design = design_size(task.space, task.settings);
  double least = 1.0;
  double most = 0.0;
  for (int i = 0; i < num_design; ++i) {
    least = std::min(least, trials[static_cast<std::size_t>(i)].point[0]);
    most = std::max(most, trials[static_cast<std::size_t>(i)].point[1]);
  }
  EXPECT_EQ(recorded_reference(storage.events()), (std::vector<double>{-least, most}));
  EXPECT_EQ(result.trade_off->reference, (std::vector<double>{-least, most}));
  EXPECT_EQ(in_score_units(task.goal, result.trade_off->reference),
            (std::vector<double>{least, most}));
  // Both are best in one corner, which the search must find: one design beats all others.
  EXPECT_NEAR(result.best->point[0], 1.0, 0.02);
  EXPECT_NEAR(result.best->point[1], 0.0, 0.02);
}

TEST(TradeOff, AReferenceInsideTheFrontIsTold) {
  SearchTask task = two_objectives(1, 20);
  task.settings.algorithm = "sobol";
  task.goal.objective.reference = 0.5;
  const TemporaryFolder folder;
  const SearchResult result = search_into(folder, task, line);
  EXPECT_GT(result.trade_off->outside, 5);
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_THAT(result.warnings[0], HasSubstr("the reference lies inside the front"));
}

/// A point at each corner of the unit square that is not the reference's: the volume is known.
TEST(TradeOff, TheHistoryOfTheHypervolumeCountsFeasibleGainsOnly) {
  const Goal goal = {.objective = {.name = "f1", .is_maximised = false},
                     .constraints = {{.name = "limit", .max = 1.0}},
                     .more_objectives = {{.name = "f2", .is_maximised = false}}};
  const auto trial = [](int number, double f1, double f2, double limit) {
    return Trial{.number = number,
                 .point = {},
                 .outcome = Outcome{
                     .scores = {{"f1", f1}, {"f2", f2}, {"limit", limit}, {"f1.error", 0.01}}}};
  };
  const std::vector<Trial> trials = {trial(1, 0.5, 0.5, 0.0),
                                     trial(2, 0.1, 0.1, 2.0),
                                     trial(3, 0.25, 0.75, 0.0),
                                     trial(4, 0.6, 0.6, 0.0)};
  const std::vector<double> reference = {1.0, 1.0};
  EXPECT_THAT(hypervolume_history(goal, trials, reference),
              testing::ElementsAre(0.25, 0.25, 0.3125, 0.3125));
  const TradeOff found = trade_off(goal, trials, reference);
  EXPECT_EQ(found.trials, (std::vector<int>{1, 3}));
  EXPECT_DOUBLE_EQ(found.hypervolume, 0.3125);
  // f1 of the first by 0.02: 0.02 * (0.75 - 0.5) of area; of the second 0.02 * (1 - 0.75).
  EXPECT_NEAR(found.noise, std::hypot(0.02 * 0.25, 0.02 * 0.25), 1e-12);
}

TEST(TradeOff, StallsWithoutAGainBeyondTheNoise) {
  SearchTask task = two_objectives(2, 400);
  task.settings.algorithm = "sobol";
  task.budget.stall = 30;
  task.goal.objective.reference = 2.0;
  task.goal.more_objectives[0].reference = 2.0;
  const auto line_with_error = [](double error) {
    return [error](const Point& p, int) {
      Outcome outcome = line(p, 0);
      outcome.scores["f1.error"] = error;
      outcome.scores["f2.error"] = error;
      return outcome;
    };
  };
  const TemporaryFolder noisy;
  const SearchResult stopped = search_into(noisy, task, line_with_error(0.1));
  EXPECT_EQ(stopped.termination, Termination::kStall);
  EXPECT_LT(stopped.evaluations, 80);
  // Without noise every new place on the line adds some area.
  const TemporaryFolder quiet;
  task.budget.evaluations = 120;
  EXPECT_EQ(search_into(quiet, task, line_with_error(0.0)).termination, Termination::kEvaluations);
}

TEST(TradeOff, WhatKnowsOneObjectiveIsRefused) {
  const auto error_of = [](const SearchTask& task) -> std::string {
    const TemporaryFolder folder;
    try {
      search_into(folder, task, zdt1);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  SearchTask task = zdt1_task("auto", 1);
  task.budget.target = 0.5;
  EXPECT_THAT(error_of(task), HasSubstr("budget.target: works with a single objective"));
  EXPECT_THAT(error_of(zdt1_task("bobyqa", 1)),
              HasSubstr("bobyqa works with a single objective only"));
  task = zdt1_task("auto", 1);
  task.goal.more_objectives[0].name = "f1";
  EXPECT_THAT(error_of(task), HasSubstr("f1: is an objective twice"));
  task = zdt1_task("auto", 1);
  task.goal.objective.aspiration = 1.2;
  EXPECT_THAT(error_of(task), HasSubstr("aspiration 1.2 must be below the reference 1.1"));
  task = zdt1_task("auto", 1);
  task.goal.choice = ChoiceRule::kAspirations;
  EXPECT_THAT(error_of(task), HasSubstr("needs an objective with an aspiration"));
}

/// Failures, a limit and batches; cut up after every few evaluations, and by the budget.
TEST(TradeOff, ACutUpSearchIsTheSameBitForBit) {
  SearchTask task = two_objectives(3, 45);
  task.settings.batch = 3;
  task.goal.constraints = {{.name = "f1", .max = 0.9}};
  const Evaluate evaluate = [](const Point& p, int trial) {
    if (trial % 13 == 5) {
      throw Error("some fail");
    }
    return zdt1(p, trial);
  };
  const TemporaryFolder whole;
  const SearchResult expected = search_into(whole, task, evaluate);
  const TemporaryFolder cut;
  SearchTask smaller = task;
  smaller.budget.evaluations = 20;
  search_into(cut, smaller, evaluate);
  SearchResult result;
  do {
    std::atomic<int> interrupt = 0;
    int calls = 0;
    result = search_into(cut, task, evaluate, &interrupt, [&](const SearchProgress&) {
      interrupt = ++calls >= 7 ? 1 : 0;
    });
  } while (result.termination == Termination::kInterrupted);
  EXPECT_EQ(events_and_points(cut), events_and_points(whole));
  EXPECT_EQ(result.best->number, expected.best->number);
  EXPECT_EQ(result.trade_off->hypervolume, expected.trade_off->hypervolume);
  const TemporaryFolder threaded;
  task.jobs = 3;
  search_into(threaded, task, evaluate);
  EXPECT_EQ(events_and_points(threaded), events_and_points(whole));
}

void drop_rules(const TemporaryFolder& folder) {
  Database database(folder / "s.sqlite", Database::Access::kReadWrite);
  database.run("DELETE FROM event WHERE kind = 'rules'");
}

/// As programs before rules left it: no event of rules, none of models.
TEST(SearchRules, ARunThatBeganWithoutRulesGoesOnByRules1) {
  SearchTask earlier = bowls_task("auto", 1);
  earlier.settings.rules = 1;
  earlier.budget.evaluations = 40;
  const TemporaryFolder whole;
  search_into(whole, earlier, two_bowls);
  const TemporaryFolder begun;
  earlier.budget.evaluations = 25;
  search_into(begun, earlier, two_bowls);
  drop_rules(begun);
  SearchTask now = bowls_task("auto", 1);
  now.budget.evaluations = 40;
  ASSERT_EQ(now.settings.rules, kSearchRules);
  search_into(begun, now, two_bowls);
  drop_rules(whole);
  EXPECT_EQ(events_and_points(begun), events_and_points(whole));
  const TemporaryFolder fresh;
  search_into(fresh, now, two_bowls);
  EXPECT_NE(events_and_points(fresh), events_and_points(whole));
}

TEST(SearchRules, AreTheFirstEventAndUnknownOnesAreRefused) {
  SearchTask task = two_objectives(2, 12);
  const TemporaryFolder folder;
  search_into(folder, task, zdt1);
  const std::vector<Event> events = Storage::read(folder / "s.sqlite").events();
  EXPECT_EQ(events.front().kind, EventKind::kRules);
  EXPECT_EQ(events.front().value, kSearchRules);
  EXPECT_THAT(events.front().text, HasSubstr("gp"));
  {
    Database database(folder / "s.sqlite", Database::Access::kReadWrite);
    database.run("UPDATE event SET value = 99 WHERE kind = 'rules'");
  }
  EXPECT_THROW(search_into(folder, task, zdt1), ConfigError);
}

/// The models of a resumed search come from the log; asking everything again gives the same.
TEST(SearchRules, AResumedSearchAsksTheSameWithAndWithoutComputingEveryAskAgain) {
  SearchTask task = two_objectives(3, 60);
  task.settings.batch = 2;
  const TemporaryFolder whole;
  search_into(whole, task, zdt1);
  test::expect_resumed_as(whole, task, zdt1, {9, 31, 44, 60});
}

/// A search by other parameters than those in the log is found by asking everything again.
TEST(SearchRules, VerifyReplayFindsAPointThatWouldNotBeAsked) {
  SearchTask task = two_objectives(3, 60);
  const TemporaryFolder folder;
  search_into(folder, task, zdt1);
  {
    Database database(folder / "s.sqlite", Database::Access::kReadWrite);
    database.run(
        "UPDATE trial SET point = (SELECT point FROM trial WHERE number = 3) WHERE number = 33");
  }
  task.verify_replay = true;
  EXPECT_THROW(search_into(folder, task, zdt1), ConfigError);
}

/// Processor time; the bound is what docs/decisions/0021-search-rules.md asks for.
TEST(SearchRules, ThreeHundredTrialsAreResumedWithinTwoSeconds) {
  SearchTask task = zdt1_task("auto", 1);
  task.budget.evaluations = 300;
  const TemporaryFolder folder;
  const std::clock_t start = std::clock();
  const SearchResult searched = search_into(folder, task, zdt1);
  const std::clock_t middle = std::clock();
  const SearchResult resumed = search_into(folder, task, zdt1);
  const std::clock_t end = std::clock();
  EXPECT_EQ(resumed.replayed, 300);
  EXPECT_EQ(resumed.best->number, searched.best->number);
  const auto ms = [](std::clock_t ticks) {
    return 1e3 * static_cast<double>(ticks) / CLOCKS_PER_SEC;
  };
  RecordProperty("search_ms", std::to_string(ms(middle - start)));
  RecordProperty("resume_ms", std::to_string(ms(end - middle)));
  EXPECT_LT(ms(end - middle), 2000.0);
}

TEST(SearchRules, UnderNoiseTheBestIsTheExpectedBest) {
  SearchTask task = {.space = box(2, 0, 1),
                     .settings = {.is_noisy = true},
                     .goal = {.objective = {.name = "f", .is_maximised = false}, .constraints = {}},
                     .budget = {.evaluations = 60}};
  const TemporaryFolder folder;
  const auto truth = [](const Point& p) {
    return std::pow(p[0] - 0.3, 2) + std::pow(p[1] - 0.6, 2);
  };
  const SearchResult result = search_into(folder, task, [&](const Point& p, int trial) {
    return Outcome{.scores = {{"f", truth(p) + 2.0 * test::noise(trial)}}};
  });
  EXPECT_EQ(result.algorithm, "gp");
  double luckiest = 1e9;
  for (const Trial& trial : Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch)) {
    luckiest = std::min(luckiest, trial.outcome->scores.at("f"));
  }
  EXPECT_GT(result.best->outcome->scores.at("f"), luckiest);
  EXPECT_LT(truth(result.best->point), 0.01);  // a tenth of the noise
}

/// By rules 4 the first trial is told twice; by later ones it is asked once. The second one is far
/// better than the others, and all that models ask for fail.
TEST(SearchRules, UnderNoiseTheExpectedBestIsThatTrialAlsoWhereAStartPointIsGivenTwice) {
  SearchTask task = {.space = box(2, 0, 1),
                     .settings = {.is_noisy = true},
                     .goal = {.objective = {.name = "f", .is_maximised = false}, .constraints = {}},
                     .budget = {.evaluations = 12}};
  task.start_points = {{0.5, 0.5}, {0.5, 0.5}, {0.25, 0.75}, {0.9, 0.1}};
  const Evaluate evaluate = [](const Point& p, int trial) {
    if (trial > 7) {
      throw Error("not to be had");
    }
    const double f = std::pow(p[0] - 0.25, 2) + std::pow(p[1] - 0.75, 2);
    return Outcome{.scores = {{"f", 10.0 * f + 0.01 * test::noise(trial)}}};
  };
  for (const int rules : {4, kSearchRules}) {
    task.settings.rules = rules;
    const TemporaryFolder folder;
    const SearchResult result = search_into(folder, task, evaluate);
    EXPECT_EQ(result.best->number, 2) << rules;
    EXPECT_EQ(result.reused, rules > 4 ? 0 : 1) << rules;
    SearchTask longer = task;
    longer.settings.rules = kSearchRules;  // a run that has begun goes on by the rules in its log
    longer.budget.evaluations = 16;
    EXPECT_EQ(search_into(folder, longer, evaluate).evaluations, 16) << rules;
  }
}

TEST(TradeOff, AnotherReferenceThanTheRecordedOneIsRefused) {
  const TemporaryFolder folder;
  SearchTask task = two_objectives(2, 20);
  search_into(folder, task, zdt1);
  task.goal.objective.reference = 3.0;  // as if the program had changed: the configuration has not
  EXPECT_THROW(search_into(folder, task, zdt1), ConfigError);
}

}  // namespace
}  // namespace glint
