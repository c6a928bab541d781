// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where rules 6 take noise into account and earlier ones do not: what counts as a gain of
// hypervolume and as reaching a target, and what models know of intervals. Where rules 7 do: what
// the front of several objectives is made of. Where rules 8 do: when another target is looked at.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "optimizer/front/front.h"
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
SearchResult search_for(const TemporaryFolder& folder,
                        double target,
                        double error,
                        int lucky,
                        int rules,
                        const std::atomic<int>* interrupt = nullptr,
                        const OnEvaluation& progress = {}) {
  const SearchTask task = {.space = test::box(2, 0, 1),
                           .settings = {.algorithm = "gp", .is_noisy = true, .rules = rules},
                           .goal = {.objective = {.name = "gain"}},
                           .budget = {.evaluations = 40, .target = target}};
  const auto evaluate = [=](const Point& p, int trial) {
    const double hill = 5.0 - 8.0 * (std::pow(p[0] - 0.3, 2) + std::pow(p[1] - 0.6, 2));
    return Outcome{.scores = {{"gain", trial == lucky ? 8.0 : hill}, {"gain.error", error}}};
  };
  return test::search_into(folder, task, evaluate, interrupt, progress);
}

SearchResult search_for(double target, double error, int lucky, int rules) {
  const TemporaryFolder folder;
  return search_for(folder, target, error, lucky, rules);
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

/// By rules 6 after each of the last 21 batches.
TEST(NoiseRules, AfterALuckyEvaluationTheModelIsAskedOnlyWhereItMayHaveComeToExpectTheTarget) {
  EXPECT_EQ(search_for(7.5, 3.0, 20, 6).target_questions, 21);
  const SearchResult found = search_for(7.5, 3.0, 20, kSearchRules);
  EXPECT_EQ(found.termination, Termination::kEvaluations);
  EXPECT_GE(found.target_questions, 2);
  EXPECT_LE(found.target_questions, 11);
}

/// When the model is asked follows from the log.
TEST(NoiseRules, ASearchThatIsCutUpReachesItsTargetWhereAWholeOneDoes) {
  const TemporaryFolder whole;
  const SearchResult expected = search_for(whole, 4.9, 0.3, 10, kSearchRules);
  ASSERT_EQ(expected.termination, Termination::kTarget);
  const TemporaryFolder cut;
  SearchResult result;
  do {
    std::atomic<int> interrupt = 0;
    result = search_for(
        cut, 4.9, 0.3, 10, kSearchRules, &interrupt, [&](const SearchProgress&) { interrupt = 1; });
  } while (result.termination == Termination::kInterrupted);
  EXPECT_EQ(result.termination, expected.termination);
  EXPECT_EQ(result.evaluations, expected.evaluations);
  EXPECT_EQ(test::events_and_points(cut), test::events_and_points(whole));
}

/// The last of 40 evaluations is unlucky, so that it is far from what is expected of the best.
SearchResult search_with_bad_end(const TemporaryFolder& folder,
                                 std::optional<double> target,
                                 int rules) {
  const SearchTask task = {.space = test::box(2, 0, 1),
                           .settings = {.algorithm = "gp", .is_noisy = true, .rules = rules},
                           .goal = {.objective = {.name = "gain"}},
                           .budget = {.evaluations = 40, .target = target}};
  return test::search_into(folder, task, [](const Point& p, int trial) {
    const double hill = 5.0 - 8.0 * (std::pow(p[0] - 0.3, 2) + std::pow(p[1] - 0.6, 2));
    return Outcome{.scores = {{"gain", trial == 40 ? 3.0 : hill}, {"gain.error", 0.05}}};
  });
}

/// What the best design of such a search was seen to have and is expected to.
double surely_reached(const SearchResult& found) {
  const double expected = found.expected.at(found.best->number).front().mean;
  return std::min(expected, found.best->outcome->scores.at("gain")) - 1e-9;
}

/// By rules 7 with the next design that is seen to reach it, or the next model.
TEST(NoiseRules, ATargetThatIsEasedEndsTheRunAtOnceWhereItIsExpectedAlready) {
  for (const std::optional<double> first : {std::optional(9.0), std::optional<double>()}) {
    const TemporaryFolder folder;
    const SearchResult before = search_with_bad_end(folder, first, kSearchRules);
    ASSERT_EQ(before.termination, Termination::kEvaluations);
    const double eased = surely_reached(before);
    ASSERT_GT(eased, 3.0);
    const SearchResult resumed = search_with_bad_end(folder, eased, kSearchRules);
    EXPECT_EQ(resumed.termination, Termination::kTarget);
    EXPECT_EQ(resumed.evaluations, 40);
    EXPECT_TRUE(resumed.warnings.empty());
  }
  const TemporaryFolder earlier;
  const double eased = surely_reached(search_with_bad_end(earlier, 9.0, 7));
  EXPECT_EQ(search_with_bad_end(earlier, eased, 7).termination, Termination::kEvaluations);
}

/// In batches of four. @param stop_at  the trial that an interrupt cuts short; 0: none
SearchResult search_in_fours(const TemporaryFolder& folder, double target, int stop_at = 0) {
  const SearchTask task = {.space = test::box(2, 0, 1),
                           .settings = {.algorithm = "gp", .batch = 4, .is_noisy = true},
                           .goal = {.objective = {.name = "gain"}},
                           .budget = {.evaluations = 40, .target = target}};
  std::atomic<int> interrupt = 0;
  const auto evaluate = [&](const Point& p, int trial) {
    if (trial == stop_at) {
      interrupt = 2;
      throw EvaluationAborted();
    }
    const double hill = 5.0 - 8.0 * (std::pow(p[0] - 0.3, 2) + std::pow(p[1] - 0.6, 2));
    return Outcome{.scores = {{"gain", hill}, {"gain.error", 0.05}}};
  };
  return test::search_into(folder, task, evaluate, &interrupt);
}

/// Trial 26 is the second of its batch.
TEST(NoiseRules, ATargetThatIsEasedAmidABatchEndsTheRunBeforeTheRestOfIt) {
  for (const double target : {4.0, 9.0}) {
    const TemporaryFolder folder;
    const SearchResult cut = search_in_fours(folder, 9.0, 26);
    ASSERT_EQ(cut.termination, Termination::kInterrupted);
    ASSERT_EQ(cut.evaluations, 25);
    const SearchResult resumed = search_in_fours(folder, target);
    const bool is_eased = target < 9.0;
    EXPECT_EQ(resumed.termination, is_eased ? Termination::kTarget : Termination::kEvaluations);
    EXPECT_EQ(resumed.evaluations, is_eased ? 25 : 40);
  }
}

TEST(NoiseRules, ATargetThatIsEasedToWhatOneLuckyEvaluationHasDoesNotEndTheRun) {
  const TemporaryFolder folder;
  search_for(folder, 9.0, 3.0, 20, kSearchRules);
  const SearchResult resumed = search_for(folder, 7.5, 3.0, 20, kSearchRules);
  EXPECT_EQ(resumed.termination, Termination::kEvaluations);
  EXPECT_EQ(resumed.target_questions, 1) << "at once";
}

std::vector<double> noted_targets(const TemporaryFolder& folder) {
  std::vector<double> targets;
  for (const Event& event : Storage::read(folder / "s.sqlite").events()) {
    if (event.kind == EventKind::kNote && !event.objectives.empty()) {
      targets.push_back(event.objectives.front());
    }
  }
  return targets;
}

/// Before the next design is asked, so that a run that is stopped before looks at it again.
TEST(NoiseRules, TheLogTellsWithWhichTargetARunGoesOn) {
  const TemporaryFolder folder;
  search_with_bad_end(folder, 9.0, kSearchRules);
  EXPECT_THAT(noted_targets(folder), testing::ElementsAre(9.0));
  search_with_bad_end(folder, 8.0, kSearchRules);
  EXPECT_THAT(noted_targets(folder), testing::ElementsAre(9.0)) << "nothing was asked";
  const TemporaryFolder without;
  search_with_bad_end(without, std::nullopt, kSearchRules);
  EXPECT_TRUE(noted_targets(without).empty());
  const TemporaryFolder earlier;
  search_with_bad_end(earlier, 9.0, 7);
  EXPECT_TRUE(noted_targets(earlier).empty());
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

const Goal kTwoScores = {.objective = {.name = "f1", .is_maximised = false},
                         .constraints = {{.name = "limit", .max = 1.0}},
                         .more_objectives = {{.name = "f2", .is_maximised = true}}};

Trial seen(int number, double f1, double f2, double limit = 0.0) {
  return {.number = number,
          .point = {},
          .outcome = Outcome{.scores = {{"f1", f1}, {"f2", f2}, {"limit", limit}}}};
}

/// The second is the lucky one. Nothing is expected of the third, the fourth is beyond the limit.
TEST(ExpectedFront, IsOfWhatIsExpectedAndNotOfTheLuckyOne) {
  const std::vector<Trial> trials = {
      seen(1, 0.5, 0.5), seen(2, 0.1, 0.9), seen(3, 0.05, 0.95), seen(4, 0.0, 1.0, 2.0)};
  const Expectations expected = {
      {1, {{0.5, 0.01}, {0.5, 0.0}}}, {2, {{0.6, 0.1}, {0.4, 0.1}}}, {4, {{0.0, 0.1}, {1.0, 0.1}}}};
  const std::vector<double> reference = {1.0, 0.0};
  EXPECT_EQ(trade_off(kTwoScores, trials, reference).trials, (std::vector<int>{3}));
  const TradeOff found = trade_off(kTwoScores, trials, reference, expected);
  EXPECT_TRUE(found.is_expected);
  EXPECT_EQ(found.trials, (std::vector<int>{1}));
  EXPECT_EQ(found.front[0], (std::vector<double>{0.5, -0.5}));
  EXPECT_DOUBLE_EQ(found.hypervolume, 0.25);
  EXPECT_NEAR(found.noise, 0.02 * 0.5, 1e-12) << "f1 by two standard deviations";
  EXPECT_EQ(found.reason, "the only design that no other is expected to beat in everything");
  EXPECT_THAT(hypervolume_history(kTwoScores, trials, reference, expected),
              testing::ElementsAre(0.25, 0.25, 0.25, 0.25));
}

TEST(ExpectedFront, WhatFollowsFromADesignIsNotModelled) {
  const std::vector<Trial> trials = {seen(1, 0.5, 0.25)};
  const std::vector<std::string> exact = {"f2"};
  const Expectations known =
      with_exact_scores(kTwoScores, trials, exact, {{1, {{0.4, 0.1}, {0.2, 0.1}}}});
  EXPECT_EQ(known.at(1)[0].mean, 0.4);
  EXPECT_EQ(known.at(1)[0].sd, 0.1);
  EXPECT_EQ(known.at(1)[1].mean, 0.25);
  EXPECT_EQ(known.at(1)[1].sd, 0.0);
}

/// Of two bowls side by side the first design is far from both; it is seen as better than any,
/// which its error tells.
SearchResult search_beside_bowls(const TemporaryFolder& folder,
                                 bool is_noisy,
                                 int evaluations,
                                 int rules) {
  const SearchTask task = {
      .space = test::box(2, 0, 1),
      .settings = {.algorithm = "gp", .is_noisy = is_noisy, .rules = rules},
      .goal = {.objective = {.name = "f1", .is_maximised = false, .reference = 2.0},
               .constraints = {},
               .more_objectives = {{.name = "f2", .is_maximised = false, .reference = 2.0}}},
      .budget = {.evaluations = evaluations},
      .start_points = {{0.5, 1.0}}};
  return test::search_into(folder, task, [](const Point& p, int trial) {
    const double off = 4.0 * std::pow(p[1] - 0.2, 2);
    const bool is_lucky = trial == 1;
    const double error = is_lucky ? 3.0 : 0.02;
    return Outcome{.scores = {{"f1", is_lucky ? -1.0 : std::pow(p[0] - 0.2, 2) + off},
                              {"f2", is_lucky ? -1.0 : std::pow(p[0] - 0.8, 2) + off},
                              {"f1.error", error},
                              {"f2.error", error}}};
  });
}

TEST(ExpectedFront, ALuckyEvaluationIsNotChosenByRules7) {
  const TemporaryFolder folder;
  const SearchResult result = search_beside_bowls(folder, true, 30, kSearchRules);
  const TradeOff& found = *result.trade_off;
  EXPECT_TRUE(found.is_expected);
  EXPECT_GT(found.trials.size(), 2U);
  EXPECT_THAT(found.trials, testing::Not(testing::Contains(1)));
  EXPECT_EQ(result.best->number, found.trials[found.chosen]);
  for (std::size_t k = 0; k < found.trials.size(); ++k) {
    EXPECT_EQ(found.front[k][0], result.expected.at(found.trials[k])[0].mean);
  }
}

/// Also goes on as it began: rules 7 ask what rules 6 ask.
TEST(ExpectedFront, ARunByRules6IsGoneOnWithAndReportedByWhatWasSeen) {
  const TemporaryFolder begun;
  search_beside_bowls(begun, true, 20, 6);
  const SearchResult resumed = search_beside_bowls(begun, true, 30, kSearchRules);
  EXPECT_EQ(resumed.rules, 6);
  EXPECT_FALSE(resumed.trade_off->is_expected);
  EXPECT_EQ(resumed.trade_off->trials, (std::vector<int>{1}));
  EXPECT_EQ(resumed.best->number, 1);
  EXPECT_EQ(resumed.trade_off->reason, "the only design that no other beats in everything");
  const TemporaryFolder fresh;
  search_beside_bowls(fresh, true, 30, kSearchRules);
  const std::vector<Trial> earlier = Storage::read(begun / "s.sqlite").trials(TrialKind::kSearch);
  const std::vector<Trial> now = Storage::read(fresh / "s.sqlite").trials(TrialKind::kSearch);
  ASSERT_EQ(earlier.size(), now.size());
  for (std::size_t k = 0; k < now.size(); ++k) {
    EXPECT_EQ(earlier[k].point, now[k].point);
  }
}

/// The only design within the limit is evaluated last, in a batch that the budget cuts: the model
/// is not told of it.
TEST(ExpectedFront, IsOfWhatWasSeenWhereNothingIsExpectedOfWhatMeetsTheLimits) {
  const SearchTask task = {
      .space = test::box(2, 0, 1),
      .settings = {.algorithm = "gp", .batch = 4, .is_noisy = true},
      .goal = {.objective = {.name = "f1", .is_maximised = false, .reference = 2.0},
               .constraints = {{.name = "late", .min = 0.5}},
               .more_objectives = {{.name = "f2", .is_maximised = false, .reference = 2.0}}},
      .budget = {.evaluations = 21}};
  const TemporaryFolder folder;
  const SearchResult result = test::search_into(folder, task, [](const Point& p, int trial) {
    return Outcome{.scores = {{"f1", p[0]},
                              {"f2", 1.0 - p[0]},
                              {"f1.error", 0.02},
                              {"f2.error", 0.02},
                              {"late", trial == 21 ? 1.0 : 0.0}}};
  });
  ASSERT_TRUE(result.best);
  EXPECT_EQ(result.best->number, 21);
  EXPECT_FALSE(result.trade_off->is_expected);
  EXPECT_EQ(result.trade_off->trials, (std::vector<int>{21}));
}

/// Also where scores tell errors, of which models make expectations.
TEST(ExpectedFront, WithoutNoiseItIsOfWhatWasSeen) {
  const TemporaryFolder folder;
  const SearchResult result = search_beside_bowls(folder, false, 20, kSearchRules);
  EXPECT_FALSE(result.expected.empty());
  EXPECT_FALSE(result.trade_off->is_expected);
  EXPECT_TRUE(result.of_front().empty());
  EXPECT_EQ(result.best->number, 1);
}

}  // namespace
}  // namespace glint
