// SPDX-License-Identifier: GPL-3.0-or-later
//
// Limits under noise by search rules 8: by what models expect of the limited scores, and in a race
// by its replicates.
#include "optimizer/search/expected_limits.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "optimizer/algorithm/exact_values.h"
#include "optimizer/search/final_race.h"
#include "tests/optimizer/search/searching.h"

namespace glint {
namespace {

const Constraint kGlare = {.name = "glare", .min = {}, .max = 2.0};
const Constraint kBetween = {.name = "between", .min = 1.0, .max = 3.0};

Trial limited(int number, double gain, double glare, double between = 2.0) {
  return {.number = number,
          .point = {0.1 * number},
          .outcome = Outcome{.scores = {{"gain", gain}, {"glare", glare}, {"between", between}}}};
}

double normal_below(double z) {
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

ExpectedLimits expected_of(std::vector<Constraint> constraints,
                           std::vector<Expectation> row,
                           std::vector<std::string> exact = {}) {
  const Goal goal = {.objective = {.name = "gain"}, .constraints = std::move(constraints)};
  const std::vector<Trial> trials = {limited(1, 1.0, 2.5)};
  const std::vector<int> told = {1};
  const std::vector<std::vector<Expectation>> rows = {std::move(row)};
  return limit_expectations_of(goal, trials, told, rows, exact).at(1);
}

/// (1.5 - 2) / 2 = -0.25 is -log(1.25) = -0.22314 to the model, so z = 2.2314; a unit of it is
/// 1.25 x 2 of the score there.
TEST(ExpectedLimits, AreThoseOfTheScoreInItsUnit) {
  const double log = log_limit(limit_values(kGlare, 1.5).front());
  const ExpectedLimits inside = expected_of({kGlare}, {{log, 0.1}});
  ASSERT_EQ(inside.scores.size(), 1U);
  EXPECT_NEAR(inside.scores[0].mean, 1.5, 1e-9);
  EXPECT_NEAR(inside.scores[0].sd, 0.25, 1e-5);
  EXPECT_NEAR(inside.probability, normal_below(2.2314), 1e-4);
  EXPECT_NEAR(expected_of({kGlare}, {{0.0, 0.1}}).probability, 0.5, 1e-4) << "on the border";
  EXPECT_NEAR(expected_of({kGlare}, {{0.1, 0.1}}).probability, normal_below(-1.0), 1e-4);
  EXPECT_EQ(expected_of({kGlare}, {{-0.1, 0.0}}).probability, 1.0);
  EXPECT_EQ(expected_of({kGlare}, {{0.1, 0.0}}).probability, 0.0);
  // 3 of at least 4 is short by 0.25.
  const Constraint bright = {.name = "glare", .min = 4.0, .max = {}};
  const double short_of = log_limit(limit_values(bright, 3.0).front());
  EXPECT_NEAR(expected_of({bright}, {{short_of, 0.1}}).scores[0].mean, 3.0, 1e-9);
}

/// First of min, z = 2, then of max, z = 1; 3 - 3 x (e^0.1 - 1) = 2.6845.
TEST(ExpectedLimits, OfTwoLimitsOfOneScoreMissNoneTwice) {
  const ExpectedLimits both = expected_of({kBetween}, {{-0.2, 0.1}, {-0.1, 0.1}});
  EXPECT_NEAR(both.probability, normal_below(2.0) + normal_below(1.0) - 1.0, 1e-4);
  EXPECT_NEAR(both.scores[0].mean, 2.6845, 1e-4) << "by the limit that is less sure";
  EXPECT_EQ(expected_of({kBetween}, {{0.3, 0.1}, {0.3, 0.1}}).probability, 0.0);
}

TEST(ExpectedLimits, OfSeveralScoresAreIndependent) {
  const ExpectedLimits all =
      expected_of({kGlare, kBetween}, {{-0.1, 0.1}, {-0.2, 0.1}, {-1.0, 0.1}});
  EXPECT_NEAR(all.probability, normal_below(1.0) * normal_below(2.0), 1e-4);
  EXPECT_EQ(all.scores.size(), 2U);
}

/// A glare of 2.5 was seen, where a model of its own would be sure of less.
TEST(ExpectedLimits, StandAsSeenWhereTheyFollowFromTheDesign) {
  const ExpectedLimits known =
      expected_of({kGlare, kBetween}, {{-1.0, 0.1}, {-1.0, 0.1}, {-1.0, 0.1}}, {"glare"});
  EXPECT_EQ(known.probability, 0.0);
  EXPECT_EQ(known.scores[0].mean, 2.5);
  EXPECT_EQ(known.scores[0].sd, 0.0);
}

const Goal kMostGain = {.objective = {.name = "gain"}, .constraints = {kGlare}};

/// The first was unlucky, the second lucky, and of the fourth nothing is expected.
const std::vector<Trial> kFour = {
    limited(1, 3.0, 2.5), limited(2, 9.0, 1.0), limited(3, 2.0, 1.0), limited(4, 1.0, 1.0)};
const LimitExpectations kOfThree = {{1, {0.9, {}}}, {2, {0.2, {}}}, {3, {0.6, {}}}};

TEST(LikelyFeasible, IsWhatIsExpectedToKeepLimitsAndNotWhatWasSeenTo) {
  const std::vector<int> told = {1, 2, 3};
  const std::vector<std::vector<Expectation>> rows = {{{-3.0, 0.1}}, {{-9.0, 0.1}}, {{-2.0, 0.1}}};
  EXPECT_EQ(expected_best(kMostGain, kFour, told, rows), 2);
  EXPECT_EQ(expected_best(kMostGain, kFour, told, rows, kOfThree), 1);
  const SearchSpace space = test::box(1, 0, 1);
  EXPECT_EQ(finalists_of(kMostGain, space, kFour, {}, 1, {.count = 4}, kOfThree),
            (std::vector<int>{1, 3, 4}));
  EXPECT_EQ(finalists_of(kMostGain, space, kFour, {}, 2, {.count = 4}, kOfThree),
            (std::vector<int>{2, 1, 3, 4}))
      << "the first in any case";
  EXPECT_EQ(finalists_of(kMostGain, space, kFour, {}, 2, {.count = 4}),
            (std::vector<int>{2, 3, 4}));
}

TEST(LikelyFeasible, IsWhatMostProbablyIsWhereNoneIsExpectedTo) {
  const LimitExpectations none = {{1, {0.3, {}}}, {2, {0.2, {}}}, {3, {0.3, {}}}};
  const auto three = std::span(kFour).first(3);
  EXPECT_EQ(most_likely_feasible(kMostGain, three, none)->number, 3) << "that was seen to";
  EXPECT_EQ(most_likely_feasible(kMostGain, three)->number, 2) << "as it was seen";
  EXPECT_EQ(most_likely_feasible(kMostGain, kFour, none)->number, 4) << "nothing else is known";
}

TEST(LikelyFeasible, MakesTheFront) {
  Goal goal = kMostGain;
  goal.more_objectives = {{.name = "between"}};
  const std::vector<Trial> trials = {limited(1, 3.0, 2.5, 1.0), limited(2, 9.0, 1.0, 5.0)};
  const LimitExpectations limits = {{1, {0.9, {}}}, {2, {0.2, {}}}};
  const std::vector<double> reference = {0.0, 0.0};
  EXPECT_EQ(trade_off(goal, trials, reference).trials, (std::vector<int>{2}));
  const TradeOff found = trade_off(goal, trials, reference, {}, limits);
  EXPECT_EQ(found.trials, (std::vector<int>{1}));
  EXPECT_DOUBLE_EQ(found.hypervolume, 3.0);
  EXPECT_THAT(hypervolume_history(goal, trials, reference, {}, limits),
              testing::ElementsAre(3.0, 3.0));
}

/// The gain grows with the glare. The first design's glare of 0.7 is seen as 0.4, below the limit,
/// which its error tells.
SearchResult search_for_gain(const TemporaryFolder& folder,
                             int rules,
                             int evaluations = 24,
                             std::optional<double> target = {},
                             double largest = 0.5) {
  const SearchTask task = {.space = test::box(2, 0, 1),
                           .settings = {.algorithm = "gp", .is_noisy = true, .rules = rules},
                           .goal = {.objective = {.name = "gain"},
                                    .constraints = {{.name = "glare", .min = {}, .max = largest}}},
                           .budget = {.evaluations = evaluations, .target = target},
                           .start_points = {{0.7, 0.5}}};
  return test::search_into(folder, task, [largest](const Point& p, int trial) {
    const bool is_lucky = trial == 1;
    return Outcome{.scores = {{"gain", p[0]},
                              {"gain.error", 0.02},
                              {"glare", is_lucky ? largest - 0.1 : p[0]},
                              {"glare.error", is_lucky ? 0.3 : 0.02}}};
  });
}

TEST(NoisyLimits, ALuckyEvaluationDoesNotMakeADesignFeasibleByRules8) {
  const TemporaryFolder folder;
  const SearchResult found = search_for_gain(folder, kSearchRules);
  ASSERT_TRUE(found.best);
  EXPECT_NE(found.best->number, 1);
  EXPECT_GT(found.best->point[0], 0.3);
  EXPECT_LT(found.best->point[0], 0.6);
  EXPECT_TRUE(found.is_feasible);
  EXPECT_LT(found.limits.at(1).probability, 0.1);
  EXPECT_GT(found.limits.at(1).scores[0].mean, 0.6);
  ASSERT_TRUE(found.judged_limits);
  EXPECT_GE(found.judged_limits->expected.probability, kFeasibleChance);
  EXPECT_FALSE(found.judged_limits->is_raced);
}

/// What is asked is the same.
TEST(NoisyLimits, ARunByRules7IsGoneOnWithAndAnsweredByWhatWasSeen) {
  const TemporaryFolder begun;
  search_for_gain(begun, 7, 16);
  const SearchResult resumed = search_for_gain(begun, kSearchRules);
  EXPECT_EQ(resumed.rules, 7);
  EXPECT_EQ(resumed.best->number, 1);
  EXPECT_TRUE(resumed.is_feasible);
  EXPECT_TRUE(resumed.limits.empty());
  EXPECT_FALSE(resumed.judged_limits);
  const TemporaryFolder fresh;
  search_for_gain(fresh, kSearchRules);
  const std::vector<Trial> earlier = Storage::read(begun / "s.sqlite").trials(TrialKind::kSearch);
  const std::vector<Trial> now = Storage::read(fresh / "s.sqlite").trials(TrialKind::kSearch);
  ASSERT_EQ(earlier.size(), now.size());
  for (std::size_t k = 0; k < now.size(); ++k) {
    EXPECT_EQ(earlier[k].point, now[k].point);
  }
}

TEST(NoisyLimits, ALargerBudgetAnswersAsFromTheStart) {
  const TemporaryFolder cut;
  search_for_gain(cut, kSearchRules, 11);
  const SearchResult resumed = search_for_gain(cut, kSearchRules);
  const TemporaryFolder whole;
  const SearchResult expected = search_for_gain(whole, kSearchRules);
  EXPECT_EQ(test::events_and_points(cut), test::events_and_points(whole));
  EXPECT_EQ(resumed.best->number, expected.best->number);
  ASSERT_EQ(resumed.limits.size(), expected.limits.size());
  for (const auto& [number, limits] : expected.limits) {
    EXPECT_EQ(resumed.limits.at(number).probability, limits.probability);
  }
}

/// All glare is above 0; the limit is -1, and the first design was seen below it.
TEST(NoisyLimits, WhereNoDesignIsExpectedToKeepThemTheAnswerIsNotFeasible) {
  const TemporaryFolder folder;
  const SearchResult found = search_for_gain(folder, kSearchRules, 16, {}, -1.0);
  ASSERT_TRUE(found.best);
  EXPECT_FALSE(found.is_feasible);
  EXPECT_LT(found.judged_limits->expected.probability, kFeasibleChance);
  const TemporaryFolder earlier;
  EXPECT_TRUE(search_for_gain(earlier, 7, 16, {}, -1.0).is_feasible);
}

/// The first design is exactly on the border, the second just beyond it.
SearchResult search_with_share(std::vector<std::string> steady, std::optional<double> largest) {
  const TemporaryFolder folder;
  const SearchTask task = {.space = test::box(2, 0, 1),
                           .settings = {.algorithm = "gp", .is_noisy = true},
                           .goal = {.objective = {.name = "gain"},
                                    .constraints = {{.name = "share", .min = 1.0, .max = largest}}},
                           .budget = {.evaluations = 16},
                           .start_points = {{0.4, 0.5}, {0.8, 0.5}},
                           .steady = std::move(steady)};
  return test::search_into(folder, task, [](const Point& p, int /*trial*/) {
    return Outcome{
        .scores = {{"gain", p[0]}, {"gain.error", 0.02}, {"share", p[0] <= 0.6 ? 1.0 : 0.999}}};
  });
}

TEST(NoisyLimits, OfScoresThatNoiseDoesNotMoveStandAsSeen) {
  for (const std::optional<double> largest : {std::optional<double>(), std::optional(1.0)}) {
    const SearchResult found = search_with_share({"share"}, largest);
    EXPECT_EQ(found.limits.at(1).probability, 1.0);
    EXPECT_EQ(found.limits.at(2).probability, 0.0);
    EXPECT_TRUE(found.is_feasible);
    EXPECT_LT(search_with_share({}, largest).limits.at(1).probability, 1.0);
  }
}

/// Only designs beyond the limit have 0.65.
TEST(NoisyLimits, ATargetIsNotReachedByADesignThatIsExpectedToMissThem) {
  const TemporaryFolder folder;
  EXPECT_EQ(search_for_gain(folder, kSearchRules, 24, 0.65).termination, Termination::kEvaluations);
  const TemporaryFolder earlier;
  EXPECT_EQ(search_for_gain(earlier, 7, 24, 0.65).termination, Termination::kTarget);
}

/// Of trial 1 each of two scores is within its limit in the mean, 0.98 of 1, by less than the
/// standard error of the mean. The mean of eight drawn signs is at most 0 with a probability of
/// 0.6367, both means independently with 0.405.
Scores nearly_within(const Entrant& entrant, int replicate) {
  const bool is_near = entrant.trial == 1;
  const double first = replicate % 2 == 0 ? 0.2 : -0.2;
  const double second = replicate % 4 < 2 ? 0.2 : -0.2;
  return {{"gain", is_near ? 12.0 : 9.0},
          {"size", is_near ? 0.98 + first : 0.5},
          {"weight", is_near ? 0.98 + second : 0.5}};
}

FinalRace race_near_limits(RaceLimits limits) {
  const TemporaryFolder folder;
  const Goal goal = {.objective = {.name = "gain"},
                     .constraints = {{.name = "size", .min = {}, .max = 1.0},
                                     {.name = "weight", .min = {}, .max = 1.0}}};
  Storage storage = Storage::open(folder / "s.sqlite", test::identity());
  const std::vector<Entrant> entrants = {{.key = "trial 1", .trial = 1, .point = {0.1}},
                                         {.key = "trial 2", .trial = 2, .point = {0.2}}};
  return *run_final_race(goal, entrants, storage, nearly_within, nullptr, limits);
}

TEST(NoisyLimits, OfARaceAreKeptWhereHalfOfTheSamplesKeepThem) {
  const FinalRace by_chance = race_near_limits(RaceLimits::kByChance);
  EXPECT_EQ(by_chance.best, 1U);
  EXPECT_NEAR(by_chance.racers[0].feasible_chance.value(), 0.405, 0.04);
  EXPECT_FALSE(by_chance.racers[0].keeps_limits);
  EXPECT_EQ(by_chance.racers[1].feasible_chance, 1.0);
  EXPECT_TRUE(by_chance.racers[1].keeps_limits);
  const FinalRace by_means = race_near_limits(RaceLimits::kByMeans);
  EXPECT_EQ(by_means.best, 0U);
  EXPECT_TRUE(by_means.racers[0].keeps_limits);
  EXPECT_FALSE(by_means.racers[0].feasible_chance);
}

TEST(NoisyLimits, OfARaceAreMissedByAnInfiniteScore) {
  const TemporaryFolder folder;
  Storage storage = Storage::open(folder / "s.sqlite", test::identity());
  const auto evaluate = [](const Entrant& entrant, int replicate) {
    const bool is_endless = entrant.trial == 1 && replicate % 2 == 0;
    return Scores{{"gain", entrant.trial == 1 ? 12.0 : 9.0},
                  {"glare", is_endless ? std::numeric_limits<double>::infinity() : 1.0}};
  };
  const std::vector<Entrant> entrants = {{.key = "trial 1", .trial = 1, .point = {0.1}},
                                         {.key = "trial 2", .trial = 2, .point = {0.2}}};
  const FinalRace found =
      *run_final_race(kMostGain, entrants, storage, evaluate, nullptr, RaceLimits::kByChance);
  EXPECT_EQ(found.best, 1U);
  EXPECT_EQ(found.racers[0].feasible_chance, 0.0);
  EXPECT_FALSE(found.racers[0].keeps_limits);
}

}  // namespace
}  // namespace glint
