// SPDX-License-Identifier: GPL-3.0-or-later
//
// A search whose rung turns out too coarse near its optimum, with evaluations that are made up: the
// cheapest rung is wrong by 1 there, where none of the twelve designs of the trial lies.
#include "studies/accuracy/accurate_search.h"

#include "studies/accuracy/accuracy_panel.h"
#include "studies/accuracy/accuracy_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "optimizer/storage/sqlite.h"
#include "studies/accuracy/outcome_labels.h"
#include "tests/studies/accuracy/faked_clock.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kMade = "homogeneity.mean";
constexpr int kEvaluations = 90;
constexpr int kCoarse = 8;  ///< samples of the rung that is wrong

const std::string kStudy = "schema = 1\n" + kPathView + kPathRing + R"([render]
method = "paths"
[render.paths]
samples = 16
max_reflections = 1
[variables]
"lighting.ring.height_mm" = { min = 20, max = 60 }
"lighting.ring.inner_radius_mm" = { min = 5, max = 20 }
[objective]
maximise = "homogeneity.mean"
[search]
algorithm = "bobyqa"
[budget]
evaluations = 90
[accuracy]
keep = ["render.method"]
tolerance = { "homogeneity.mean" = 0.2 }
)";

/// In the unit square: best at (0.83, 0.21).
Outcome made_up(double x, double y, const RenderRung& rung, bool is_ever_wrong) {
  const double square = std::pow(x - 0.83, 2) + std::pow(y - 0.21, 2);
  const int samples = rung.paths.samples;
  double score = 1.0 - square + 0.02 * std::sin(9.0 * x + 7.0 * y) / std::sqrt(samples);
  score += is_ever_wrong && samples == kCoarse && square < 0.0036 ? 1.0 : 0.0;
  return {.scores = {{kMade, score}, {"homogeneity.clipped_share", 0.0}}};  // of the usual limit
}

struct Result {
  SearchResult search;
  AccurateSearch found;
  nlohmann::ordered_json check;
  nlohmann::ordered_json told;  ///< accuracy_json()
  int evaluations = 0;          ///< in this process, of search and trial
};

/// A run in a folder, as that of studies/run.
/// @param stop_at  the evaluation that an interrupt cuts short; 0: none
/// @param left     what its reviews are told
Result run_in(const TemporaryFolder& folder,
              int stop_at = 0,
              bool is_ever_wrong = true,
              TimeLeft left = TimeLeft::kSome) {
  write_file(folder / "study.toml", kStudy);
  const Study study = load_study(folder / "study.toml", {});
  ThreadPool pool(1);
  SceneStore store(pool);
  const StudyIdentity identity = {.config_hash = "abc", .config_text = "", .code_version = "test"};
  Storage storage = Storage::open(folder / "study.sqlite", identity);
  Storage record = Storage::open(folder / "accuracy.sqlite", identity);
  std::atomic<int> interrupt = 0;
  Result result;
  const auto evaluate = [&](const Overrides& overrides, const RenderRung& rung) {
    if (++result.evaluations == stop_at) {
      interrupt = 2;
      throw EvaluationAborted();
    }
    const double x = (overrides.at(0).second.number - 20.0) / 40.0;
    const double y = (overrides.at(1).second.number - 5.0) / 15.0;
    return made_up(x, y, rung, is_ever_wrong);
  };
  const auto search = [&](const ChosenAccuracy& chosen, const Review& review) {
    return run_search(
        {.space = study.space,
         .settings = study.search,
         .goal = study.goal,
         .budget = study.budget,
         .start_points = {baseline_point(study)},
         .review = [&](std::span<const Trial> told, TimeLeft) { return review(told, left); },
         .label = [&](const Point&) { return searched_label(study, chosen.rung().name); }},
        storage,
        [&](const Point& point, int) {
          const auto known = chosen.known.find(point);
          return known != chosen.known.end() ? known->second
                                             : evaluate(overrides_of(study, point), chosen.rung());
        },
        &interrupt);
  };
  result.search = search_accurately({.study = study,
                                     .store = store,
                                     .record = &record,
                                     .interrupt = &interrupt,
                                     .evaluate = evaluate},
                                    storage,
                                    search,
                                    result.found);
  if (result.found.check) {
    result.check = check_json(*result.found.chosen, *result.found.check, kEvaluations);
    result.told = accuracy_json(study, *result.found.chosen, kEvaluations, {"polarisation: 1 %"});
    result.told["check"] = result.check;
  }
  return result;
}

std::string trials_of(const TemporaryFolder& folder) {
  std::string text;
  for (const Trial& trial : Storage::read(folder / "study.sqlite").trials(TrialKind::kSearch)) {
    text += fmt::format("{} {:a}", trial.number, fmt::join(trial.point, " "));
    text += trial.outcome ? fmt::format(" {:a}\n", trial.outcome->scores.at(kMade)) : " -\n";
  }
  return text;
}

TEST(SearchReview, RaisesTheRungWhereADesignIsBeyondTheBound) {
  const TemporaryFolder folder;
  const Result result = run_in(folder);
  ASSERT_TRUE(result.found.check);
  const AccuracyCheck& check = *result.found.check;
  ASSERT_THAT(check.ended, SizeIs(1));
  EXPECT_EQ(check.ended[0].rung, "direct light, 8 samples");
  EXPECT_THAT(check.ended[0].sentence,
              HasSubstr("differs between \"direct light, 8 samples\" and"));
  EXPECT_GE(check.ended[0].evaluations, kUncheckedEvaluations);
  EXPECT_EQ(result.found.chosen->rung().paths.samples, 16);
  EXPECT_EQ(result.found.chosen->designs.front(), trial_name(check.ended[0].trial));
  EXPECT_EQ(result.search.evaluations, kEvaluations);
  // No score of the first rung is left, and the best is the true one.
  for (const Trial& trial : Storage::read(folder / "study.sqlite").trials(TrialKind::kSearch)) {
    EXPECT_LT(trial.outcome->scores.at(kMade), 1.1);
  }
  const std::vector<double> unit = {(result.search.best->point[0] - 20.0) / 40.0,
                                    (result.search.best->point[1] - 5.0) / 15.0};
  EXPECT_NEAR(unit[0], 0.83, 0.05);
  EXPECT_NEAR(unit[1], 0.21, 0.05);
  EXPECT_EQ(result.check["epochs"].size(), 1U);
  EXPECT_THAT(result.check["sentence"].get<std::string>(),
              HasSubstr("evaluated again by \"direct light, 16 samples\""));
}

// What was found beyond its bound is told, and begins its epoch when there is time.
TEST(SearchReview, WithoutTimeLeftItOnlyLooks) {
  const TemporaryFolder folder;
  const Result late = run_in(folder, 0, true, TimeLeft::kNone);
  EXPECT_THAT(late.found.check->ended, IsEmpty());
  EXPECT_EQ(late.search.evaluations, kEvaluations);
  EXPECT_EQ(late.found.chosen->rung().paths.samples, kCoarse);
  EXPECT_EQ(late.check["during"]["beyond"], 1);
  EXPECT_THAT(late.check["sentence"].get<std::string>(), HasSubstr("The bounds do not hold here"));
  const Result result = run_in(folder);
  EXPECT_THAT(result.found.check->ended, SizeIs(1));
  EXPECT_EQ(result.found.chosen->rung().paths.samples, 16);
}

/// "direct light, 8 samples": trials that have an outcome there.
std::map<std::string, int> replicates_by_rung(const TemporaryFolder& folder) {
  std::map<std::string, int> count;
  const Storage storage = Storage::read(folder / "study.sqlite");
  for (const Replicate& replicate : storage.replicates(TrialKind::kSearch)) {
    EXPECT_EQ(replicate.replicate, 0);
    EXPECT_EQ(replicate.seed, 1U);
    ++count[replicate.rung];
  }
  return count;
}

TEST(SearchReview, EveryOutcomeOfATrialIsKeptByItsRung) {
  const TemporaryFolder folder;
  const Result result = run_in(folder);
  const std::map<std::string, int> count = replicates_by_rung(folder);
  ASSERT_THAT(result.found.check->ended, SizeIs(1));
  EXPECT_EQ(count.at("direct light, 8 samples"), result.found.check->ended[0].evaluations)
      << "the withdrawn ones";
  EXPECT_EQ(count.at("direct light, 16 samples"), kEvaluations);
  EXPECT_GE(count.at(result.found.chosen->top().name), 1) << "finalists";
  const Storage storage = Storage::read(folder / "study.sqlite");
  const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
  for (const Replicate& replicate : storage.replicates(TrialKind::kSearch)) {
    if (replicate.rung == result.found.chosen->rung().name) {
      const Trial& trial = trials[static_cast<std::size_t>(replicate.number - 1)];
      EXPECT_EQ(replicate.outcome.scores.at(kMade), trial.outcome->scores.at(kMade));
    }
  }
}

/// Everything but times.
std::string replicates_of(const TemporaryFolder& folder) {
  std::string text;
  const Storage storage = Storage::read(folder / "study.sqlite");
  for (const Replicate& one : storage.replicates(TrialKind::kSearch)) {
    text += fmt::format(
        "{} {} {} {:a}\n", one.number, one.rung, one.seed, one.outcome.scores.at(kMade));
  }
  return text;
}

TEST(SearchReview, OutcomesAreKeptWhenTheyAreMadeAndOnce) {
  const TemporaryFolder whole;
  const Result expected = run_in(whole);
  const TemporaryFolder folder;
  run_in(folder, expected.evaluations - 12);  // in the second epoch, none of which is over
  const std::map<std::string, int> count = replicates_by_rung(folder);
  EXPECT_EQ(count.at("direct light, 8 samples"), expected.found.check->ended[0].evaluations);
  const std::vector<Trial> trials =
      Storage::read(folder / "study.sqlite").trials(TrialKind::kSearch);
  const auto evaluated = static_cast<int>(
      std::ranges::count_if(trials, [](const Trial& trial) { return trial.outcome.has_value(); }));
  EXPECT_GT(evaluated, expected.found.check->ended[0].evaluations);
  EXPECT_GE(count.at("direct light, 16 samples"), evaluated);
  // Some lost: as a kill between two databases leaves it, and a program that kept them at its end.
  Database(folder / "study.sqlite", Database::Access::kReadWrite)
      .run(
          "DELETE FROM replicate WHERE number % 3 = 0; "
          "DELETE FROM replicate_value WHERE number % 3 = 0");
  run_in(folder);
  EXPECT_EQ(replicates_of(folder), replicates_of(whole));
}

/// As the program before wrote it.
void make_schema_6(const std::filesystem::path& path) {
  Database(path, Database::Access::kReadWrite)
      .run("DROP TABLE replicate; DROP TABLE replicate_value; PRAGMA user_version = 6");
}

TEST(SearchReview, ARunOfSchema6GoesOnToTheSame) {
  const TemporaryFolder whole;
  const Result expected = run_in(whole);
  const TemporaryFolder folder;
  run_in(folder, expected.evaluations - 20);
  make_schema_6(folder / "study.sqlite");
  make_schema_6(folder / "accuracy.sqlite");
  EXPECT_TRUE(replicates_by_rung(folder).empty()) << "and it is read as it is";
  const Result result = run_in(folder);
  EXPECT_EQ(trials_of(folder), trials_of(whole));
  EXPECT_EQ(result.check, expected.check);
  EXPECT_EQ(replicates_of(folder), replicates_of(whole)) << "the withdrawn ones, too";
}

// Choice, checks, epoch and what is told, whatever clocks say: at once, and when going on.
TEST(SearchReview, NoClockHasASayInWhatIsDecided) {
  const TemporaryFolder real;
  const Result expected = run_in(real);
  for (const unsigned seed : {1U, 2U}) {
    const TemporaryFolder folder;
    const test::FakedClock clock(seed);
    run_in(folder, seed == 1 ? 0 : 50);  // the second one is cut short
    const Result result = run_in(folder);
    EXPECT_EQ(trials_of(folder), trials_of(real)) << seed;
    EXPECT_EQ(result.check, expected.check) << seed;
    EXPECT_EQ(result.told, expected.told) << seed;
    EXPECT_GT(result.found.cpu_s, 1000.0 + expected.found.cpu_s) << "else no clock was faked";
    EXPECT_GT(test::FakedClock::looks(), 10);
  }
}

TEST(SearchReview, KeepsTheRungWhereTheBoundHolds) {
  const TemporaryFolder folder;
  const Result result = run_in(folder, 0, false);
  EXPECT_THAT(result.found.check->ended, IsEmpty());
  EXPECT_EQ(result.found.chosen->rung().paths.samples, kCoarse);
  EXPECT_GE(result.found.check->during.size(), 2U);
  EXPECT_EQ(result.check["during"]["beyond"], 0);
  EXPECT_EQ(result.check["beyond"], 0);
}

// Counted: of the search after its first twenty evaluations, at any moment.
TEST(SearchReview, ChecksTakeNoMoreThanATenthOfTheWork) {
  for (const bool is_ever_wrong : {false, true}) {
    const TemporaryFolder folder;
    const Result result = run_in(folder, 0, is_ever_wrong);
    EXPECT_LE(result.check["share"].get<double>(), kCheckShare);
    EXPECT_GT(result.check["share"].get<double>(), 0.0);
    for (const EndedEpoch& epoch : result.found.check->ended) {
      EXPECT_LE(epoch.check_work, kCheckShare * epoch.search_work);
    }
  }
}

TEST(SearchReview, CutShortAnywhereItComesToTheSame) {
  const TemporaryFolder whole;
  const Result expected = run_in(whole);
  const std::string trials = trials_of(whole);
  for (int stop_at = 1; stop_at < expected.evaluations; stop_at += 5) {
    const TemporaryFolder folder;
    Result result = run_in(folder, stop_at);
    EXPECT_EQ(result.search.termination, Termination::kInterrupted) << stop_at;
    EXPECT_FALSE(result.found.check) << stop_at;
    int evaluations = result.evaluations - 1;
    result = run_in(folder);
    evaluations += result.evaluations;
    EXPECT_EQ(trials_of(folder), trials) << stop_at;
    EXPECT_EQ(result.check, expected.check) << stop_at;
    EXPECT_EQ(result.search.best->number, expected.search.best->number) << stop_at;
    EXPECT_EQ(evaluations, expected.evaluations) << stop_at << ": nothing is evaluated twice";
  }
}

/// What resuming a run in the folder is refused with; empty: it is not.
/// @param stop_at  the evaluation that an interrupt cuts short: 1 for a refusal before any
std::string refusal_in(const TemporaryFolder& folder, int stop_at = 0) {
  try {
    run_in(folder, stop_at);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

void note_begin(const TemporaryFolder& folder, double rules, const std::string& rung) {
  const StudyIdentity identity = Storage::read(folder / "study.sqlite").identity();
  Storage::open(folder / "accuracy.sqlite", identity)
      .append(std::vector<Event>{{.kind = EventKind::kRules, .value = rules, .text = rung}});
}

// Its accuracy.sqlite does not tell by which rules: those of programs before there were any. Taking
// what they chose for what is chosen now would mix scores of two rungs.
TEST(SearchReview, RefusesToGoOnWithWhatOtherRulesChose) {
  const int in_search = 60;
  const TemporaryFolder folder;
  ASSERT_EQ(run_in(folder, in_search).search.termination, Termination::kInterrupted);
  ASSERT_GT(Storage::read(folder / "study.sqlite").trials(TrialKind::kSearch).size(), 1U);
  std::filesystem::remove(folder / "accuracy.sqlite");
  EXPECT_THAT(refusal_in(folder), HasSubstr("was chosen by accuracy rules 1"));
  note_begin(folder, kCombinedRules + 1.0, "direct light, 8 samples");
  EXPECT_THAT(refusal_in(folder), HasSubstr("was begun by a newer Glint (accuracy rules 5"));
}

/// As if the search had begun with another rung, and one had not been there to be tried.
/// @param unknown  the name of that one; empty: none
void rewrite_record(const TemporaryFolder& folder,
                    const std::string& begun,
                    const std::string& unknown) {
  const std::vector<Trial> trials =
      Storage::read(folder / "accuracy.sqlite").trials(TrialKind::kPart);
  std::filesystem::remove(folder / "accuracy.sqlite");
  note_begin(folder, kAccuracyRules, begun);
  const StudyIdentity identity = Storage::read(folder / "study.sqlite").identity();
  Storage record = Storage::open(folder / "accuracy.sqlite", identity);
  for (const Trial& trial : trials) {
    if (unknown.empty() || !trial.name.starts_with(unknown + " |")) {
      record.put_trial(trial);
    }
  }
}

TEST(SearchReview, RefusesToGoOnWithAnotherRungThanItBeganWith) {
  const int in_search = 60;
  const TemporaryFolder folder;
  run_in(folder, in_search);
  rewrite_record(folder, "direct light, 32 samples", "");
  EXPECT_THAT(refusal_in(folder),
              HasSubstr("began with \"direct light, 32 samples\" and would now begin with "
                        "\"direct light, 8 samples\""));
}

// A program before had no such rung. What its trial would be now need not be evaluated to tell that
// it was another one.
TEST(SearchReview, RefusesALadderWithANewRungBeforeAnyEvaluation) {
  const int in_search = 60;
  const TemporaryFolder folder;
  run_in(folder, in_search);
  rewrite_record(folder, "direct light, 16 samples", "direct light, 8 samples");
  EXPECT_THAT(refusal_in(folder, 1),
              HasSubstr("its search began with \"direct light, 16 samples\", and \"direct light, 8 "
                        "samples\" would now be tried before"));
}

// Cut short while the ladder was tried: nothing rests on the choice yet.
TEST(SearchReview, ChoosesByItsOwnRulesWhereTheSearchHasNotBegun) {
  const int in_trial = 10;
  const TemporaryFolder folder;
  ASSERT_EQ(run_in(folder, in_trial).search.termination, Termination::kInterrupted);
  EXPECT_THAT(Storage::read(folder / "accuracy.sqlite").events(), IsEmpty());
  EXPECT_EQ(refusal_in(folder), "");
}

TEST(AccuracyPanel, SaysAllInOnePlace) {
  const TemporaryFolder folder;
  const nlohmann::ordered_json panel = accuracy_panel(run_in(folder).told);
  std::map<std::string, std::string> facts;
  for (const auto& row : panel["tables"][0]["rows"]) {
    facts[row[0].get<std::string>()] = row[1].get<std::string>();
  }
  EXPECT_EQ(facts.at("asked for"), "0.2 of homogeneity.mean, at a confidence of 99 %");
  EXPECT_EQ(facts.at("level"), "direct light");
  EXPECT_EQ(facts.at("rendered by"), "direct light, 16 samples");
  EXPECT_EQ(facts.at("settings"), "samples = 16, max_reflections = 1");
  EXPECT_THAT(facts.at("errors of one more design"), HasSubstr("mean within 0."));
  EXPECT_NE(facts.at("of all designs, unchecked ones too"), facts.at("errors of one more design"));
  EXPECT_THAT(facts.at("checked"), HasSubstr("evaluated again by"));
  EXPECT_THAT(facts.at("checking took"), HasSubstr("% of the search"));
  // 64 samples instead of 16, and half a sample of scoring for the picture.
  EXPECT_THAT(facts.at("full physics would have taken"), HasSubstr("% of the search"));
  EXPECT_EQ(panel["tables"][2]["rows"][0][0], "polarisation: 1 %");
}

TEST(SearchReview, SaysThatNothingDearerIsThereToCompareWith) {
  const TemporaryFolder folder;
  Result result = run_in(folder, 0, false);
  ChosenAccuracy at_top = *result.found.chosen;
  at_top.choice.step = at_top.ladder.size() - 1;
  EXPECT_EQ(second_rung(at_top), nullptr);
  EXPECT_FALSE(has_dearer_rung(at_top));
  EXPECT_THAT(check_json(at_top, {}, kEvaluations)["sentence"].get<std::string>(),
              HasSubstr("the wide bounds"));
}

}  // namespace
}  // namespace glint
