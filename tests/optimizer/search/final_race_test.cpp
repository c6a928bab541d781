// SPDX-License-Identifier: GPL-3.0-or-later
//
// Races of finalists whose true values are known, and what a search expects of its designs.
#include "optimizer/search/final_race.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <set>

#include "core/rng.h"
#include "optimizer/search/expectations.h"
#include "tests/optimizer/search/searching.h"

namespace glint {
namespace {

const Goal kMaxGain = {.objective = {.name = "gain"}};
const Goal kBounded = {.objective = {.name = "gain"},
                       .constraints = {{.name = "size", .min = {}, .max = 1.0}}};

double normal(std::uint64_t index, int replicate) {
  return Rng(1, Stream::kTest, 1000 * index + static_cast<std::uint64_t>(replicate)).normal();
}

Entrant trial_of(int number) {
  return {.key = "trial " + std::to_string(number), .trial = number, .point = {0.1 * number}};
}

/// Truths by the number of the trial; noise that all share, and a little of their own.
struct NoisyBench {
  std::map<int, double> truth;
  double sigma = 0.1;
  std::uint64_t seed = 0;
  int evaluated = 0;

  Scores operator()(const Entrant& entrant, int replicate) {
    ++evaluated;
    const auto own = 10 * seed + static_cast<std::uint64_t>(entrant.trial) + 1;
    return {
        {"gain",
         truth.at(entrant.trial) + normal(10 * seed, replicate) + sigma * normal(own, replicate)},
        {"size", entrant.trial == 3 ? 1.5 : 0.5}};
  }
};

class FinalRaceTest : public testing::Test {
 protected:
  FinalRace race(const Goal& goal, const std::vector<Entrant>& entrants, NoisyBench& bench) {
    Storage storage = Storage::open(folder_ / "s.sqlite", test::identity());
    return *run_final_race(goal, entrants, storage, std::ref(bench));
  }

  TemporaryFolder folder_;
};

TEST_F(FinalRaceTest, TheBestByFreshNumbersWinsAndWhoTrailsIsGivenUp) {
  NoisyBench bench{.truth = {{1, 9.0}, {2, 10.0}, {3, 2.0}}};
  const FinalRace found = race(kMaxGain, {trial_of(1), trial_of(2), trial_of(3)}, bench);
  EXPECT_EQ(found.best, 1U);
  EXPECT_GT(found.racers[1].probability, 0.98);
  EXPECT_EQ(found.racers[1].replicates.size(), static_cast<std::size_t>(kAllReplicates));
  EXPECT_TRUE(found.racers[2].is_given_up);
  EXPECT_EQ(found.racers[2].replicates.size(), static_cast<std::size_t>(kFirstReplicates));
  EXPECT_EQ(found.racers[2].probability, 0.0);
  EXPECT_EQ(found.evaluations, bench.evaluated);
  EXPECT_LT(bench.evaluated, 3 * kAllReplicates);
}

TEST_F(FinalRaceTest, ADesignOutsideALimitIsNotTheBest) {
  NoisyBench bench{.truth = {{1, 9.0}, {3, 12.0}}};
  const FinalRace found = race(kBounded, {trial_of(1), trial_of(3)}, bench);
  EXPECT_EQ(found.best, 0U);
  EXPECT_FALSE(found.racers[1].keeps_limits);
  EXPECT_TRUE(found.racers[0].keeps_limits);
}

TEST_F(FinalRaceTest, TheWinnerIsATrialWhateverItIsComparedWith) {
  NoisyBench bench{.truth = {{0, 20.0}, {1, 9.0}, {2, 9.5}}};
  const Entrant prototype = {.key = "half"};
  const FinalRace found = race(kMaxGain, {trial_of(1), trial_of(2), prototype}, bench);
  EXPECT_EQ(found.best, 1U);
  EXPECT_FALSE(found.racers[1].is_given_up);
  EXPECT_GT(found.racers[2].probability, 0.99);
}

TEST_F(FinalRaceTest, OneThatCannotBeEvaluatedIsOutAndIsTriedOnceInEachRun) {
  int tried = 0;
  const auto evaluate = [&](const Entrant& entrant, int replicate) -> Scores {
    if (entrant.trial == 2) {
      ++tried;
      throw ConfigError("the wall is too near");
    }
    return {{"gain", normal(7, replicate)}};
  };
  Storage storage = Storage::open(folder_ / "s.sqlite", test::identity());
  const std::vector<Entrant> entrants = {trial_of(2), trial_of(1)};
  for (int i = 0; i < 2; ++i) {
    const auto found = run_final_race(kMaxGain, entrants, storage, evaluate);
    EXPECT_EQ(found->best, 1U);
    EXPECT_TRUE(found->racers[0].is_given_up);
    EXPECT_NEAR(found->racers[1].probability, 1.0, 1e-9);
  }
  EXPECT_EQ(tried, 2);
  const std::vector<Trial> raced = storage.trials(TrialKind::kReplicate);
  EXPECT_EQ(std::ranges::count(raced, entrants[0].key, &Trial::name), 1);
}

// By a program that did not ask for the score of the goal, or in a state in which it could not be
// had. It is the best design, and takes the place of its failures.
TEST_F(FinalRaceTest, WhatFailedInAnEarlierRunIsTriedAgain) {
  const std::vector<Entrant> entrants = {trial_of(2), trial_of(1)};
  Storage storage = Storage::open(folder_ / "s.sqlite", test::identity());
  NoisyBench bench{.truth = {{1, 9.0}, {2, 10.0}}};
  const auto lacking = [&](const Entrant& entrant, int replicate) {
    Scores scores = bench(entrant, replicate);
    scores.erase(entrant.trial == 2 ? "gain" : "nothing");
    return scores;
  };
  EXPECT_EQ(run_final_race(kMaxGain, entrants, storage, lacking)->best, 1U);
  bench.evaluated = 0;
  const auto found = run_final_race(kMaxGain, entrants, storage, std::ref(bench));
  EXPECT_EQ(found->best, 0U);
  EXPECT_EQ(found->racers[0].replicates.size(), static_cast<std::size_t>(kAllReplicates));
  EXPECT_EQ(bench.evaluated, kAllReplicates) << "the other one's are there";
  std::set<std::pair<std::string, double>> replicates;
  for (const Event& event : storage.events()) {
    EXPECT_TRUE(replicates.emplace(event.text, event.value).second) << "each is one event";
  }
  for (const Trial& trial : storage.trials(TrialKind::kReplicate)) {
    EXPECT_FALSE(trial.outcome->is_failed);
  }
  NoisyBench whole_bench{.truth = bench.truth};
  const TemporaryFolder whole;
  Storage of_whole = Storage::open(whole / "s.sqlite", test::identity());
  EXPECT_EQ(
      run_final_race(kMaxGain, entrants, of_whole, std::ref(whole_bench))->racers[0].replicates,
      found->racers[0].replicates);
}

/// Cut short after every number of evaluations it comes to the same.
TEST_F(FinalRaceTest, ThatIsCutShortGoesOnWithoutEvaluatingTwice) {
  const std::vector<Entrant> entrants = {trial_of(1), trial_of(2), trial_of(3), {.key = "half"}};
  const NoisyBench bench{.truth = {{0, 9.3}, {1, 9.0}, {2, 9.2}, {3, 4.0}}};
  NoisyBench whole_bench = bench;
  const FinalRace whole = race(kMaxGain, entrants, whole_bench);
  for (int stop = 1; stop < whole.evaluations; ++stop) {
    const TemporaryFolder folder;
    Storage storage = Storage::open(folder / "s.sqlite", test::identity());
    NoisyBench part = bench;
    std::atomic<int> interrupt = 0;
    const auto stopping = [&](const Entrant& entrant, int replicate) {
      Scores scores = part(entrant, replicate);
      interrupt = part.evaluated == stop ? 1 : 0;
      return scores;
    };
    EXPECT_FALSE(run_final_race(kMaxGain, entrants, storage, stopping, &interrupt));
    const auto rest = run_final_race(kMaxGain, entrants, storage, std::ref(part));
    ASSERT_TRUE(rest);
    EXPECT_EQ(part.evaluated, whole.evaluations);
    EXPECT_EQ(rest->best, whole.best);
    for (std::size_t i = 0; i < entrants.size(); ++i) {
      EXPECT_EQ(rest->racers[i].replicates, whole.racers[i].replicates);
      EXPECT_EQ(rest->racers[i].probability, whole.racers[i].probability);
    }
  }
}

TEST_F(FinalRaceTest, EveryReplicateIsAnEventAndATrialOfItsOwn) {
  NoisyBench bench{.truth = {{0, 5.0}, {1, 9.0}}};
  race(kMaxGain, {trial_of(1), {.key = "half"}}, bench);
  const Storage storage = Storage::read(folder_ / "s.sqlite");
  const std::vector<Event> events = storage.events();
  const std::vector<Trial> trials = storage.trials(TrialKind::kReplicate);
  ASSERT_EQ(static_cast<int>(events.size()), bench.evaluated);
  ASSERT_EQ(events.size(), trials.size());
  std::set<std::pair<std::string, int>> seen;
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i].kind, EventKind::kReplicate);
    EXPECT_EQ(events[i].text, trials[i].name);
    EXPECT_EQ(events[i].trial, events[i].text == "half" ? 0 : 1);
    EXPECT_TRUE(trials[i].outcome->scores.contains("gain"));
    EXPECT_TRUE(seen.emplace(events[i].text, static_cast<int>(events[i].value)).second);
  }
  EXPECT_TRUE(storage.trials(TrialKind::kSearch).empty());
}

/// All of them by trial or name of the design, without times.
std::multiset<std::string> kept_in_race(const TemporaryFolder& folder) {
  const Storage storage = Storage::read(folder / "s.sqlite");
  const std::vector<Trial> raced = storage.trials(TrialKind::kReplicate);
  std::multiset<std::string> texts;
  for (const TrialKind kind : {TrialKind::kSearch, TrialKind::kReplicate}) {
    for (const Replicate& one : storage.replicates(kind)) {
      const bool is_of_search = kind == TrialKind::kSearch;
      const auto index = static_cast<std::size_t>(is_of_search ? 0 : one.number - 1);
      texts.insert(
          fmt::format("{} {} {} {} {:a}",
                      is_of_search ? "trial " + std::to_string(one.number) : raced[index].name,
                      one.rung,
                      one.replicate,
                      one.seed,
                      one.outcome.scores.at("gain")));
    }
  }
  return texts;
}

TEST_F(FinalRaceTest, EveryReplicateIsKeptAsAnOutcomeOfItsDesign) {
  const std::vector<Entrant> entrants = {trial_of(1), trial_of(2), {.key = "half"}};
  const NoisyBench bench{.truth = {{0, 9.3}, {1, 9.0}, {2, 9.2}}};
  const auto label = [](const Entrant&, int replicate) {
    return OutcomeLabel{.rung = "own", .replicate = 9 + replicate, .seed = 100};
  };
  NoisyBench whole_bench = bench;
  {
    Storage storage = Storage::open(folder_ / "s.sqlite", test::identity());
    run_final_race(
        kMaxGain, entrants, storage, std::ref(whole_bench), nullptr, RaceLimits::kByMeans, label);
  }
  std::multiset<std::string> expected;
  for (const Trial& raced : Storage::read(folder_ / "s.sqlite").trials(TrialKind::kReplicate)) {
    const int before = static_cast<int>(std::ranges::count_if(
        expected, [&](const std::string& text) { return text.starts_with(raced.name + " "); }));
    expected.insert(fmt::format(
        "{} own {} 100 {:a}", raced.name, 9 + before, raced.outcome->scores.at("gain")));
  }
  EXPECT_EQ(kept_in_race(folder_), expected);
  EXPECT_EQ(static_cast<int>(expected.size()), whole_bench.evaluated);
  // A race of a program that kept none goes on, also without one of those that raced.
  const TemporaryFolder before;
  Storage storage = Storage::open(before / "s.sqlite", test::identity());
  NoisyBench part = bench;
  run_final_race(kMaxGain, entrants, storage, std::ref(part));
  EXPECT_TRUE(kept_in_race(before).empty());
  run_final_race(kMaxGain,
                 {entrants[0], entrants[2]},
                 storage,
                 std::ref(part),
                 nullptr,
                 RaceLimits::kByMeans,
                 label);
  EXPECT_GE(part.evaluated, whole_bench.evaluated);
  EXPECT_TRUE(std::ranges::includes(kept_in_race(before), expected));
}

SearchTask noisy_task(int evaluations) {
  return {.space = test::box(2, 0, 1),
          .settings = {.algorithm = "gp", .is_noisy = true},
          .goal = {.objective = {.name = "gain"}},
          .budget = {.evaluations = evaluations}};
}

double hill(const Point& p) {
  return 5.0 - 8.0 * (std::pow(p[0] - 0.3, 2) + std::pow(p[1] - 0.6, 2));
}

Outcome noisy_hill(const Point& p, int trial) {
  return {.scores = {{"gain", hill(p) + 0.4 * normal(99, trial)}}};
}

/// A raised budget after a race gives the bits of the larger budget from the start.
TEST_F(FinalRaceTest, ASearchGoesOnAfterItAsIfThereHadBeenNone) {
  const TemporaryFolder whole;
  test::search_into(whole, noisy_task(24), noisy_hill);
  test::search_into(folder_, noisy_task(15), noisy_hill);
  NoisyBench bench{.truth = {{1, 9.0}, {2, 9.1}}};
  race(kMaxGain, {trial_of(1), trial_of(2)}, bench);
  test::search_into(folder_, noisy_task(24), noisy_hill);
  Storage raced = Storage::open(folder_ / "s.sqlite", test::identity());
  const auto of_search = [](const Storage& storage) {
    std::vector<std::pair<int, double>> told;
    for (const Event& event : storage.events()) {
      if (event.kind == EventKind::kTell) {
        told.emplace_back(event.trial, event.value);
      }
    }
    return told;
  };
  EXPECT_EQ(of_search(raced), of_search(Storage::read(whole / "s.sqlite")));
}

/// Four designs, true values spread as the noise of their replicates: chances as stated, joint test
/// at 1 %.
TEST_F(FinalRaceTest, ProbabilitiesAreWhatIsObserved) {
  Storage storage = Storage::open(folder_ / "s.sqlite", test::identity());
  double stated = 0.0;
  double variance = 0.0;
  double observed = 0.0;
  const char* wanted = std::getenv("GLINT_NUM_CASES");
  const int num_cases = wanted != nullptr ? std::stoi(wanted) : 150;
  for (int i = 0; i < num_cases; ++i) {
    NoisyBench bench{.sigma = 1.0, .seed = 100 + static_cast<std::uint64_t>(i)};
    std::vector<Entrant> entrants;
    for (int k = 1; k <= 4; ++k) {
      bench.truth[k] = 1.06 * normal(5000 + static_cast<std::uint64_t>(i), k);
      entrants.push_back(trial_of(k));
      entrants.back().key += " of case " + std::to_string(i);
    }
    const auto best =
        std::ranges::max_element(bench.truth, {}, [](const auto& entry) { return entry.second; });
    const auto found = run_final_race(kMaxGain, entrants, storage, std::ref(bench));
    const double chance = found->racers[found->best].probability;
    stated += chance;
    variance += chance * (1.0 - chance);
    observed += entrants[found->best].trial == best->first ? 1.0 : 0.0;
  }
  EXPECT_LT(std::abs(observed - stated), 2.58 * std::sqrt(variance));
  EXPECT_LT(stated, 0.95 * num_cases) << "some are close, or the test shows nothing";
}

TEST(RaceSize, IsOneOfTwelveEvaluationsBetweenTwoAndEight) {
  EXPECT_EQ(race_size(10), 2);
  EXPECT_EQ(race_size(48), 4);
  EXPECT_EQ(race_size(300), 8);
}

Trial told_trial(int number, Point point, double gain, double size = 0.5) {
  return {.number = number,
          .point = std::move(point),
          .outcome = Outcome{.scores = {{"gain", gain}, {"size", size}}}};
}

TEST(FinalistsOf, AreTheBestByWhatIsExpectedAndNoTwoAlike) {
  const std::vector<Trial> trials = {told_trial(1, {0.1, 0.1}, 1.0),
                                     told_trial(2, {0.5, 0.5}, 4.0),
                                     told_trial(3, {0.9, 0.2}, 3.0),
                                     told_trial(4, {0.905, 0.205}, 2.9),
                                     told_trial(5, {0.2, 0.8}, 9.0, 2.0),
                                     told_trial(6, {0.7, 0.7}, 2.0)};
  const SearchSpace space = test::box(2, 0, 1);
  EXPECT_EQ(finalists_of(kBounded, space, trials, {}, 6, {.count = 3}),
            (std::vector<int>{6, 2, 3}));
  // The model takes most of trial 2 for luck and expects more of 1; 5 is outside the limit.
  const Expectations expected = {{1, {{3.5, 0.1}}}, {2, {{2.5, 0.1}}}};
  EXPECT_EQ(finalists_of(kBounded, space, trials, expected, 6, {.count = 9}),
            (std::vector<int>{6, 1, 3, 2}));
}

// Kind 0 has the three best designs; of kind 1 the better one comes last, and of kind 2 nothing is
// within the limit.
TEST(FinalistsOf, HaveOneOfEachKind) {
  const SearchSpace space = {
      {{.name = "x"},
       {.name = "kind", .kind = Variable::Kind::kChoice, .choices = {"a", "b", "c"}}}};
  const std::vector<Trial> trials = {told_trial(1, {0.1, 0.0}, 6.0),
                                     told_trial(2, {0.4, 1.0}, 1.0),
                                     told_trial(3, {0.6, 0.0}, 5.0),
                                     told_trial(4, {0.7, 1.0}, 2.0),
                                     told_trial(5, {0.5, 2.0}, 9.0, 2.0),
                                     told_trial(6, {0.9, 0.0}, 4.0)};
  EXPECT_EQ(finalists_of(kBounded, space, trials, {}, 1, {.count = 2}), (std::vector<int>{1, 3}));
  EXPECT_EQ(finalists_of(kBounded, space, trials, {}, 1, {.count = 2, .kinds = 1}),
            (std::vector<int>{1, 3, 4}));
  const Expectations expected = {{2, {{3.0, 0.1}}}};
  EXPECT_EQ(finalists_of(kBounded, space, trials, expected, 1, {.count = 2, .kinds = 1}),
            (std::vector<int>{1, 3, 2}));
  EXPECT_EQ(finalists_of(kBounded, space, trials, {}, 1, {.count = 5, .kinds = 1}),
            (std::vector<int>{1, 3, 6, 4, 2}));
}

TEST(SearchResult, ExpectsOfNoisyDesignsWhatTheyTrulyAre) {
  const TemporaryFolder folder;
  const SearchResult found = test::search_into(folder, noisy_task(60), noisy_hill);
  ASSERT_EQ(found.expected.size(), 60U);
  const Storage storage = Storage::read(folder / "s.sqlite");
  int inside = 0;
  double seen_error = 0.0;
  double expected_error = 0.0;
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    const Expectation& expected = found.expected.at(trial.number).front();
    EXPECT_GT(expected.sd, 0.0);
    inside += std::abs(hill(trial.point) - expected.mean) <= 2.0 * expected.sd ? 1 : 0;
    seen_error += std::abs(trial.outcome->scores.at("gain") - hill(trial.point));
    expected_error += std::abs(expected.mean - hill(trial.point));
  }
  EXPECT_GE(inside, 48);
  EXPECT_LT(expected_error, 0.6 * seen_error);
}

TEST(SearchResult, ExpectsNothingWithoutNoise) {
  const TemporaryFolder folder;
  SearchTask task = noisy_task(20);
  task.settings.is_noisy = false;
  const auto exact = [](const Point& p, int) { return Outcome{.scores = {{"gain", hill(p)}}}; };
  EXPECT_TRUE(test::search_into(folder, task, exact).expected.empty());
  const TemporaryFolder noisy;
  const auto with_error = [](const Point& p, int) {
    return Outcome{.scores = {{"gain", hill(p)}, {"gain.error", 0.1}}};
  };
  EXPECT_EQ(test::search_into(noisy, task, with_error).expected.size(), 20U);
}

}  // namespace
}  // namespace glint
