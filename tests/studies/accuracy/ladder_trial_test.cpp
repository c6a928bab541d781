// SPDX-License-Identifier: GPL-3.0-or-later
//
// The choice of a rung, with designs whose scores are made up: candidate k has the true score k.
#include "studies/accuracy/ladder_trial.h"

#include <cmath>
#include <map>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "studies/accuracy/search_figures.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kScore = "homogeneity.h_rms";

/// A ladder whose steps have errors; counts what is evaluated.
struct FakeLadder {
  LadderTask task;
  std::vector<std::function<double(std::size_t candidate)>> errors;  ///< of each step
  double top_error = 0.0;
  std::function<bool(std::size_t candidate)> fails = [](std::size_t) { return false; };
  std::map<std::size_t, int> evaluations = {};   ///< of each step
  std::optional<std::size_t> failing_step = {};  ///< that renders nothing

  void add(const std::string& name,
           double work,
           int group,
           std::function<double(std::size_t)> error,
           bool is_for_search = true) {
    task.steps.push_back(
        {.name = name, .work = work, .group = group, .is_for_search = is_for_search});
    errors.push_back(std::move(error));
  }

  LadderChoice choose() {
    const EvaluateStep evaluate = [&](std::size_t step, std::span<const std::size_t> candidates) {
      std::vector<std::optional<Scores>> found;
      for (const std::size_t candidate : candidates) {
        ++evaluations[step];
        const double truth = static_cast<double>(candidate);
        const bool is_lost = fails(candidate) || failing_step == step;
        found.push_back(is_lost ? std::optional<Scores>()
                                : Scores{{kScore, truth + errors[step](candidate)},
                                         {std::string(kScore) + ".error", top_error}});
      }
      return found;
    };
    return try_ladder(task, evaluate);
  }
};

double none(std::size_t /*candidate*/) {
  return 0.0;
}

std::function<double(std::size_t)> alternating(double size, double bias = 0.0) {
  return [=](std::size_t candidate) { return bias + (candidate % 2 == 0 ? size : -size); };
}

FakeLadder ladder_of_three(double tolerance) {
  FakeLadder ladder;
  ladder.task.goal.objective = {.name = kScore, .is_maximised = true};
  ladder.task.wish.is_auto = tolerance == 0.0;
  if (tolerance > 0.0) {
    ladder.task.wish.wishes = {{.score = kScore, .tolerance = tolerance}};
  }
  ladder.add("8", 1.0, 0, alternating(1.0, 0.5));
  ladder.add("16", 2.0, 0, alternating(0.1));
  ladder.add("top", 10.0, 0, none);
  return ladder;
}

TEST(TryLadder, TakesTheCheapestStepWithinTheTolerance) {
  EXPECT_EQ(ladder_of_three(20.0).choose().step, 0U);
  EXPECT_EQ(ladder_of_three(1.0).choose().step, 1U);
  const LadderChoice tight = ladder_of_three(0.01).choose();
  EXPECT_EQ(tight.step, 2U);
  EXPECT_TRUE(tight.is_reached);
  EXPECT_THAT(tight.unreached, IsEmpty());
}

// Errors of +-0.1 over 12 designs: bias 0, spread 0.1 sqrt(12 / 11) = 0.1044. Factors of 12 normal
// errors at the confidence 0.99: 3.1058 sqrt(13 / 12) and 5.088.
TEST(TryLadder, TellsBiasSpreadAndBound) {
  const LadderChoice choice = ladder_of_three(1.0).choose();
  ASSERT_EQ(choice.steps[1].bounds.size(), 1U);
  const ScoreBound& bound = choice.steps[1].bounds[0];
  EXPECT_NEAR(bound.bias, 0.0, 1e-12);
  EXPECT_NEAR(bound.spread, 0.10445, 1e-5);
  EXPECT_NEAR(bound.bound, 3.2326 * bound.spread, 1e-4);
  EXPECT_NEAR(bound.wide_bound, 5.0882 * bound.spread, 1e-4);
  EXPECT_EQ(bound.tolerance, 1.0);
}

TEST(TryLadder, EvaluatesNoStepThatIsDearerThanTheOneThatServes) {
  FakeLadder ladder = ladder_of_three(20.0);
  const LadderChoice choice = ladder.choose();
  EXPECT_EQ(ladder.evaluations[0], 12);
  EXPECT_EQ(ladder.evaluations[1], 0);
  EXPECT_EQ(ladder.evaluations[2], 12);
  EXPECT_EQ(choice.steps[1].skipped, "a cheaper one serves");
  EXPECT_TRUE(choice.steps[2].serves) << "the top, which was tried";
  EXPECT_EQ(choice.work, 12 * 1.0 + 12 * 10.0);
}

TEST(TryLadder, CountsTheTopsOwnErrorInEveryBound) {
  FakeLadder ladder = ladder_of_three(1.0);
  ladder.top_error = 0.5;  // three standard deviations of it are beyond the tolerance
  const LadderChoice choice = ladder.choose();
  EXPECT_FALSE(choice.is_reached);
  EXPECT_EQ(choice.step, 2U) << "the dearest";
  ASSERT_EQ(choice.unreached.size(), 1U);
  EXPECT_THAT(choice.unreached[0], HasSubstr("homogeneity.h_rms: 1 is not reachable; \"top\""));
  EXPECT_NEAR(choice.steps[2].bounds[0].bound, 3.2326 * 0.5, 1e-4);
}

// A score that noise makes smaller, by 0.4 / sqrt(samples): the top, at 64 samples, is off by 0.05.
TEST(TryLadder, CountsWhatTheTopLosesByNoise) {
  FakeLadder ladder;
  ladder.task.goal.objective = {.name = kScore, .is_maximised = true};
  ladder.task.wish.wishes = {{.score = kScore, .tolerance = 0.2}};
  for (const int samples : {8, 16, 32, 64}) {
    ladder.add(std::to_string(samples), samples, 0, [samples](std::size_t) {
      return -0.4 / std::sqrt(samples);
    });
    ladder.task.steps.back().fineness = samples;
    ladder.task.steps.back().is_noisy = true;
  }
  const LadderChoice choice = ladder.choose();
  EXPECT_EQ(choice.step, 0U);
  EXPECT_EQ(ladder.evaluations[1], 0);
  EXPECT_EQ(ladder.evaluations[2], 12) << "below the top";
  const ScoreBound& bound = choice.steps[0].bounds[0];
  EXPECT_NEAR(bound.top_bias, -0.4 / 8.0, 1e-12);
  EXPECT_NEAR(bound.top_spread, 0.0, 1e-12);
  EXPECT_NEAR(bound.bound, 0.4 / std::sqrt(8.0), 1e-12) << "all that is missing";
}

/// Samples from 8 to 64, whose noise falls as their root.
FakeLadder noisy_ladder(std::initializer_list<int> samples) {
  FakeLadder ladder;
  ladder.task.goal.objective = {.name = kScore, .is_maximised = true};
  ladder.task.wish.wishes = {{.score = kScore, .tolerance = 5.0}};
  for (const int number : samples) {
    ladder.add(std::to_string(number), number, 0, [number](std::size_t) {
      return -0.4 / std::sqrt(number);
    });
    ladder.task.steps.back().fineness = number;
    ladder.task.steps.back().is_noisy = true;
  }
  return ladder;
}

// By 32 samples it would be the same: what the top loses falls as the root.
TEST(TryLadder, TakesACoarserStepThanTheOneThatCannotRender) {
  FakeLadder ladder = noisy_ladder({8, 16, 32, 64});
  ladder.failing_step = 2;
  EXPECT_NEAR(ladder.choose().steps[3].bounds[0].top_bias, -0.4 / 8.0, 1e-12);
}

TEST(TryLadder, TellsNoBoundWhereNothingTellsHowFarTheTopIsOff) {
  for (FakeLadder ladder : {noisy_ladder({40, 64}), noisy_ladder({64})}) {
    const LadderChoice choice = ladder.choose();
    EXPECT_FALSE(choice.is_reached);
    EXPECT_THAT(choice.problem, HasSubstr("\"64\" itself is off cannot be estimated"));
  }
}

// What it loses differs from design to design.
TEST(TryLadder, CountsTheSpreadOfWhatTheTopLosesButNotItsNoise) {
  FakeLadder ladder;
  ladder.task.goal.objective = {.name = kScore, .is_maximised = true};
  ladder.task.wish.wishes = {{.score = kScore, .tolerance = 9.0}};
  ladder.add("32", 1.0, 0, alternating(0.1));
  ladder.add("128", 4.0, 0, none);
  ladder.task.steps[0].fineness = 32.0;
  ladder.task.steps[1].fineness = 128.0;
  ladder.task.steps[1].is_noisy = true;
  EXPECT_NEAR(ladder.choose().steps[0].bounds[0].top_spread, 0.10445, 1e-5);
  ladder.top_error = 0.2;
  EXPECT_EQ(ladder.choose().steps[0].bounds[0].top_spread, 0.0);
}

// Without noise the top may be off by as much as it differs from the next coarser step.
TEST(TryLadder, TheTopOfALadderWithoutNoiseHasAnErrorToo) {
  FakeLadder ladder = ladder_of_three(5.0);
  ladder.task.steps[0].fineness = 1.0;
  ladder.task.steps[1].fineness = 8.0;
  ladder.task.steps[2].fineness = 10.0;
  const ScoreBound bound = ladder.choose().steps[2].bounds[0];
  EXPECT_NEAR(bound.top_bias, 0.5, 1e-12);
  EXPECT_NEAR(bound.top_spread, 1.0445, 1e-4);
  EXPECT_NEAR(bound.bound, 0.5 + 3.2326 * 1.0445, 1e-3) << "although it is compared with itself";
}

TEST(BoundOf, IsWiderForADesignThatIsNoisierThanThoseTried) {
  const ScoreBound bound = {.score = kScore, .factor = 5.0, .bound = 1.0};
  EXPECT_EQ(bound_of(bound, {{kScore, 3.0}}), 1.0);
  EXPECT_EQ(bound_of(bound, {{kScore, 3.0}, {std::string(kScore) + ".error", 0.1}}), 1.0);
  EXPECT_EQ(bound_of(bound, {{kScore, 3.0}, {std::string(kScore) + ".error", 0.4}}), 2.0);
}

TEST(TryLadder, SharesAreOfTheMeanValueAtTheTop) {
  FakeLadder ladder = ladder_of_three(1.0);
  ladder.task.wish.wishes = {{.score = kScore, .tolerance = 0.2, .is_relative = true}};
  // Mean of 0 to 11: 5.5, so 20 % are 1.1.
  EXPECT_NEAR(ladder.choose().steps[1].bounds[0].tolerance, 1.1, 1e-12);
}

TEST(TryLadder, AutoTakesTheCheapestThatRanksRightly) {
  FakeLadder ladder = ladder_of_three(0.0);
  ladder.errors[0] = [](std::size_t candidate) { return -2.0 * static_cast<double>(candidate); };
  const LadderChoice choice = ladder.choose();
  EXPECT_EQ(choice.step, 1U) << "the first turns the order around, the second keeps it";
  EXPECT_EQ(choice.steps[0].orders[0].agreement.tau, -1.0);
  EXPECT_EQ(choice.steps[1].orders[0].agreement.tau, 1.0);
}

TEST(TryLadder, AutoAsksForTheWinnerToo) {
  FakeLadder ladder = ladder_of_three(0.0);
  // All in order but the best, which is put behind the second: 65 of 66 pairs are right.
  ladder.errors[0] = [](std::size_t candidate) { return candidate == 11 ? -1.5 : 0.0; };
  EXPECT_EQ(ladder.choose().step, 1U);
  ladder.top_error = 1.0;  // now 10 and 11 are within two standard errors
  EXPECT_EQ(ladder.choose().step, 0U);
}

TEST(TryLadder, LimitsCountInTheOrder) {
  FakeLadder ladder = ladder_of_three(0.0);
  ladder.task.goal.constraints = {{.name = kScore, .max = 5.0}};
  const auto figures = search_figures(
      ladder.task.goal, std::vector<Scores>{{{kScore, 4.0}}, {{kScore, 5.0}}, {{kScore, 10.0}}});
  // Spread 6, violation of 10 by 5 / 5 = 1: -10 + 3 * 6 * log 2.
  EXPECT_THAT(figures[0], ElementsAre(-4.0, -5.0, -10.0 + 18.0 * std::log1p(1.0)));
}

TEST(TryLadder, TakesTheNextCandidateForOneThatFails) {
  FakeLadder ladder = ladder_of_three(20.0);
  ladder.fails = [](std::size_t candidate) { return candidate % 2 == 1; };
  const LadderChoice choice = ladder.choose();
  EXPECT_EQ(choice.designs.size(), 12U);
  EXPECT_EQ(choice.designs.back(), 22U);
  EXPECT_EQ(choice.num_failed, 11U);
  EXPECT_TRUE(choice.is_reached);
}

TEST(TryLadder, SaysWhyNothingCanBeJudged) {
  FakeLadder ladder = ladder_of_three(20.0);
  ladder.fails = [](std::size_t candidate) { return candidate > 1; };
  const LadderChoice choice = ladder.choose();
  EXPECT_FALSE(choice.is_reached);
  EXPECT_EQ(choice.step, 2U);
  EXPECT_EQ(choice.problem, "2 of 48 designs can be evaluated by \"top\", 3 are needed");
}

TEST(TryLadder, LeavesOutGroupsThatMoreSamplesDoNotMend) {
  FakeLadder ladder;
  ladder.task.goal.objective = {.name = kScore, .is_maximised = true};
  ladder.task.wish.wishes = {{.score = kScore, .tolerance = 1.0}};
  ladder.add("direct, 8", 1.0, 1, alternating(0.5, 3.0));
  ladder.add("all, 8", 1.5, 2, alternating(0.5));
  ladder.add("direct, 16", 2.0, 1, alternating(0.1, 3.0));
  ladder.add("all, 16", 3.0, 2, alternating(0.05));
  ladder.add("all, 32", 6.0, 2, none);
  const LadderChoice choice = ladder.choose();
  EXPECT_EQ(ladder.evaluations[2], 0) << "direct light is 3 off, however many samples";
  EXPECT_EQ(choice.steps[2].skipped, "\"direct, 8\" differs from \"all, 8\" by too much");
  EXPECT_EQ(choice.step, 3U);
}

// Few samples of paths are 3 off by their noise: that is no fault of what has none.
TEST(TryLadder, ComparesStepsWithoutNoiseWithTheTopAlone) {
  FakeLadder ladder;
  ladder.task.goal.objective = {.name = kScore, .is_maximised = true};
  ladder.task.wish.wishes = {{.score = kScore, .tolerance = 1.0}};
  ladder.add("blurred", 0.5, 0, alternating(0.05));
  ladder.add("paths, 8", 1.0, 2, alternating(0.5, 3.0));
  ladder.add("paths, 32", 6.0, 2, none);
  ladder.task.steps[1].is_noisy = ladder.task.steps[2].is_noisy = true;
  const LadderChoice choice = ladder.choose();
  EXPECT_EQ(choice.steps[0].skipped, "");
  EXPECT_EQ(choice.step, 0U);
}

TEST(TryLadder, TakesTheDearestOfTheTopsKindWhereNoneServes) {
  FakeLadder ladder;
  ladder.task.goal.objective = {.name = kScore, .is_maximised = true};
  ladder.task.wish.wishes = {{.score = kScore, .tolerance = 0.01}};
  ladder.add("paths, 8", 1.0, 2, alternating(0.5));
  ladder.add("blurred", 2.0, 0, alternating(0.5));
  ladder.add("paths, 32", 6.0, 2, none, false);
  ladder.task.steps[0].is_noisy = ladder.task.steps[2].is_noisy = true;
  ladder.failing_step = 1;
  const LadderChoice choice = ladder.choose();
  EXPECT_FALSE(choice.is_reached);
  EXPECT_EQ(choice.step, 0U) << "the other one renders nothing";
}

TEST(TryLadder, SaysThatAStepCannotRenderEveryDesign) {
  FakeLadder ladder = ladder_of_three(20.0);
  ladder.failing_step = 0;
  const LadderChoice choice = ladder.choose();
  EXPECT_EQ(choice.steps[0].skipped, "cannot render every design");
  EXPECT_FALSE(choice.steps[0].serves);
  EXPECT_EQ(choice.step, 1U);
}

TEST(TryLadder, NeverSearchesWithAStepThatIsOnlyComparedWith) {
  FakeLadder ladder = ladder_of_three(0.01);
  ladder.task.steps.back().is_for_search = false;
  const LadderChoice choice = ladder.choose();
  EXPECT_EQ(choice.step, 1U);
  EXPECT_FALSE(choice.is_reached);
  EXPECT_THAT(choice.unreached[0], HasSubstr("\"16\" reaches"));
}

TEST(TryLadder, SaysThatTheTopItselfRanksNothing) {
  FakeLadder ladder = ladder_of_three(0.0);
  ladder.task.steps.back().is_for_search = false;
  ladder.top_error = 100.0;
  const LadderChoice choice = ladder.choose();
  EXPECT_FALSE(choice.is_reached);
  EXPECT_THAT(choice.unreached, ElementsAre(HasSubstr("\"top\", which ranks none of them")));
}

// h is known by the first step alone, the dent's contrast by the second alone.
TEST(TryLadder, SaysWhatTheTakenStepReachesWhereNoneReachesAll) {
  LadderTask task;
  task.goal.objective = {.name = "h", .is_maximised = true};
  task.wish.is_auto = false;
  task.wish.wishes = {{.score = "h", .tolerance = 1.0}, {.score = "dent", .tolerance = 1.0}};
  task.steps = {{.name = "first", .work = 1.0},
                {.name = "second", .work = 2.0},
                {.name = "top", .work = 9.0, .is_for_search = false}};
  const auto evaluate = [](std::size_t step, std::span<const std::size_t> candidates) {
    std::vector<std::optional<Scores>> found;
    for (const std::size_t candidate : candidates) {
      const double truth = static_cast<double>(candidate);
      found.emplace_back(Scores{{"h", truth + (step == 1 ? 2.0 : 0.0)},
                                {"dent", truth + (step == 0 ? 3.0 : 0.0)}});
    }
    return found;
  };
  const LadderChoice choice = try_ladder(task, evaluate);
  EXPECT_FALSE(choice.is_reached);
  EXPECT_THAT(
      choice.unreached,
      ElementsAre("h: \"second\", which is taken, reaches 2 in place of 1; no way to render "
                  "reaches all scores at once"));
}

// 2000 ladders of normal errors with random bias and spread: of the steps that are taken, new
// designs leave the tolerance in at most 1 % with the confidence 0.99, so in far less on average.
TEST(TryLadder, KeepsItsPromiseForDesignsThatWereNotTried) {
  int taken = 0;
  int beyond = 0;
  for (std::uint64_t trial = 0; trial < 2000; ++trial) {
    Rng rng(7, Stream::kTest, trial);
    const double bias = rng.uniform(-1.0, 1.0);
    const double spread = rng.uniform(0.0, 1.0);
    FakeLadder ladder = ladder_of_three(3.0);
    ladder.errors[0] = [&](std::size_t) { return bias + spread * rng.normal(); };
    const LadderChoice choice = ladder.choose();
    if (choice.step == 0) {
      ++taken;
      beyond += std::abs(bias + spread * rng.normal()) > 3.0 ? 1 : 0;
    }
  }
  EXPECT_GT(taken, 300);
  EXPECT_LE(beyond, taken / 100);
}

/// Steps "half" (off by 3 and +-0.1), "8" (noise +-1, off by -0.4) and "32" below a top of 64.
FakeLadder ladder_with_half(double tolerance) {
  FakeLadder ladder;
  ladder.task.goal.objective = {.name = kScore, .is_maximised = true};
  ladder.task.wish.wishes = {{.score = kScore, .tolerance = tolerance}};
  ladder.add("half", 1.0, -1, alternating(0.1, 3.0));
  ladder.add("8", 2.0, 0, alternating(1.0, -0.4));
  ladder.add("32", 8.0, 0, alternating(0.05, -0.2));
  ladder.add("top", 16.0, 0, none);
  const std::vector<double> fineness = {16.0, 8.0, 32.0, 64.0};
  for (std::size_t i = 0; i < fineness.size(); ++i) {
    ladder.task.steps[i].fineness = fineness[i];
    ladder.task.steps[i].is_noisy = true;
  }
  ladder.task.steps[0].is_corrected = true;
  return ladder;
}

// From 32 to 64 samples 0.2 are gained, so that the top may be off by
// 0.2 sqrt(32) / (8 - sqrt(32)) = 0.483. What is left of half resolution beside it is 3.2326 times
// the spread of 0.1 sqrt(12 / 11) and what the steps of +-0.05 come to.
TEST(TryLadder, ACorrectedStepHasNoBiasLeft) {
  FakeLadder ladder = ladder_with_half(1.2);
  const LadderChoice choice = ladder.choose();
  EXPECT_EQ(choice.step, 0U);
  ASSERT_TRUE(choice.is_reached);
  EXPECT_NEAR(choice.steps[0].offsets.at(kScore), 3.0, 1e-12);
  const ScoreBound& bound = choice.steps[0].bounds[0];
  EXPECT_NEAR(bound.bias, 0.0, 1e-12);
  EXPECT_NEAR(bound.spread, 0.10445, 1e-5);
  EXPECT_GT(bound.bound, 0.483 + 3.2326 * 0.10445);
  EXPECT_LT(bound.bound, 1.2);
}

TEST(TryLadder, ACorrectedStepIsCheckedByOneThatIsAsFine) {
  FakeLadder ladder = ladder_with_half(1.2);
  const LadderChoice choice = ladder.choose();
  ASSERT_TRUE(choice.second.has_value());
  EXPECT_EQ(*choice.second, 2U) << "not by 8 samples, which are off by more than it";
  ASSERT_EQ(choice.steps[2].bounds.size(), 1U);
  EXPECT_NEAR(choice.steps[2].bounds[0].bias, -0.2, 1e-12);
  EXPECT_EQ(ladder.evaluations[1], 0);
}

TEST(TryLadder, ACorrectedStepIsTakenOnlyWhereItServes) {
  FakeLadder ladder = ladder_with_half(1.2);
  ladder.errors[0] = alternating(0.5, 3.0);  // 3.2326 of them are beyond 1.2
  const LadderChoice choice = ladder.choose();
  EXPECT_NE(choice.step, 0U);
  EXPECT_FALSE(choice.steps[0].serves);
  EXPECT_TRUE(choice.steps[0].skipped.empty());
}

// By 8 samples six of 66 pairs are the wrong way round: tau is 0.82. Designs of other ladders may
// be far enough away.
TEST(TryLadder, LeavesTheRankingToWhoeverJudgesSeveralLadders) {
  FakeLadder ladder = ladder_of_three(0.0);
  EXPECT_EQ(ladder.choose().step, 1U);
  ladder.task.is_judged_jointly = true;
  const LadderChoice choice = ladder.choose();
  EXPECT_EQ(choice.step, 0U);
  EXPECT_NEAR(choice.steps[0].orders[0].agreement.tau, 1.0 - 12.0 / 66.0, 1e-12);
  ASSERT_EQ(choice.scores.size(), choice.top_scores.size());
  EXPECT_EQ(choice.scores[3].at(kScore), 2.5);
  EXPECT_EQ(choice.top_scores[3].at(kScore), 3.0);
}

}  // namespace
}  // namespace glint
