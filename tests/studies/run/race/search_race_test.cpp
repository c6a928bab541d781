// SPDX-License-Identifier: GPL-3.0-or-later
//
// What noise leaves of the winner of a study: its race, its true value, and how both are told.
#include "studies/run/search_race.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "optimizer/storage/storage.h"
#include "studies/run/results/judged_limits.h"
#include "studies/run/results/noise_panel.h"
#include "studies/run/run.h"
#include "studies/run/run_report.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

const std::string kNoisyRing = "schema = 1\n" + kPathPlate + kPathRing + R"(
[prototypes.low]
title = "As low as can be"
"lighting.ring.height_mm" = 20
[variables]
"lighting.ring.height_mm" = { min = 20, max = 40 }
[objective]
maximise = "defects.min_weber"
[search]
noisy = true
[budget]
evaluations = 10
)";

const std::string kNoRace = kNoisyRing + "race = 0\n";

Json run_noisy(const TemporaryFolder& folder,
               const std::string& name,
               const std::string& text = kNoisyRing,
               std::atomic<int>* interrupt = nullptr) {
  write_file(folder / "study.toml", text);
  return run_study(load_study(folder / "study.toml", {}),
                   {.out = folder / name,
                    .threads = 2,
                    .jobs = 1,
                    .progress = Progress::Style::kNone,
                    .interrupt = interrupt});
}

/// Each evaluation of a run, without [accuracy], has one place: the search's, the race's, and the
/// winner's once more.
void expect_outcomes_kept(const Storage& storage, const Json& result) {
  const int best = result.at("best").at("trial");
  const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
  int searched = 0;
  int repeated = 0;
  int rescored = 0;
  std::size_t raced = storage.replicates(TrialKind::kReplicate).size();
  for (const Replicate& one : storage.replicates(TrialKind::kSearch)) {
    const bool is_own = one.rung == "[render]";
    const Scores& scores = one.outcome.scores;
    if (is_own && one.replicate == 0) {
      ++searched;
      EXPECT_EQ(one.seed, 1U);
      const Trial& trial = trials[static_cast<std::size_t>(one.number) - 1];
      EXPECT_EQ(scores.at("defects.min_weber"), trial.outcome->scores.at("defects.min_weber"));
    } else if (is_own) {
      EXPECT_EQ(one.seed, 2000004U + 1000U * static_cast<unsigned>(one.replicate - 1));
      repeated += one.replicate <= 8 ? 1 : 0;
      raced += one.replicate <= 8 ? 0 : 1;
    } else {
      ++rescored;
      EXPECT_EQ(one.rung, "[render], re-scored");
      EXPECT_EQ(one.seed, 1000004U);
      EXPECT_EQ(scores.at("defects.min_weber"),
                result["rescored"]["best"]["defects.min_weber"].get<double>());
    }
    EXPECT_TRUE(one.replicate == 0 || one.replicate > 8 || one.number == best);
  }
  EXPECT_EQ(result.at("evaluations"), searched);
  EXPECT_EQ(repeated, 8);
  EXPECT_EQ(rescored, 1);
  EXPECT_EQ(result.at("race").at("evaluations"), raced);
}

/// What a run has left, for tests that only read it.
struct NoisyRun {
  TemporaryFolder folder;
  Json result = {};

  std::filesystem::path out() const { return folder / "out"; }
};

/// Of that text, made once.
const NoisyRun& noisy_run(const std::string& text = kNoisyRing) {
  static std::map<std::string, NoisyRun> made;
  const auto [at, is_new] = made.try_emplace(text);
  if (is_new) {
    at->second.result = run_noisy(at->second.folder, "out", text);
  }
  return at->second;
}

/// Of one finalist, in a small picture and without a prototype.
std::string race_of_one() {
  std::string text = kNoisyRing + "race = 1\n";
  const std::size_t prototype = text.find("[prototypes.low]");
  text.erase(prototype, text.find("[variables]") - prototype);
  for (const auto& [key, value] : {std::pair{"width_px = 48", "width_px = 24"},
                                   std::pair{"height_px = 32", "height_px = 16"},
                                   std::pair{"object_pixel_mm = 0.2", "object_pixel_mm = 0.4"}}) {
    text.replace(text.find(key), std::string(key).size(), value);
  }
  return text;
}

/// Who races where one design was searched: that which the study's file describes, as far as the
/// space has it.
std::set<std::string> entrants_beside_start(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", text);
  const Study study = load_study(folder / "study.toml", {});
  Storage storage = Storage::open(folder / "study.sqlite", {.config_hash = "abc"});
  const Trial start = {.number = 1,
                       .point = baseline_point(study),
                       .outcome = Outcome{.scores = {{"defects.min_weber", 0.1}}}};
  storage.append(std::vector<Event>{{.kind = EventKind::kAsk, .trial = 1}}, std::vector{start});
  SearchResult search = {.best = start, .is_feasible = true, .evaluations = 1};
  ThreadPool pool(1);
  SceneStore store(pool);
  const Json race = race_finalists(store, study, storage, search, nullptr);
  std::set<std::string> keys;
  for (const Json& row : race.at("entrants")) {
    keys.insert(row.at("key").get<std::string>());
  }
  return keys;
}

/// A baseline of 50 mm is not the design at 40 mm that the search has in its place.
TEST(SearchRace, ABaselineOutsideTheSpaceRacesBesideTheDesignInItsPlace) {
  std::string text = race_of_one();
  EXPECT_EQ(entrants_beside_start(text), (std::set<std::string>{"winner"}));
  text.replace(text.find("height_mm = 30"), 14, "height_mm = 50");
  EXPECT_EQ(entrants_beside_start(text), (std::set<std::string>{"winner", "baseline"}));
}

/// 0.1 + 2 * 0.1 is not 0.3, but for all that is rendered it is.
TEST(SearchRace, ABaselineOnAStepOfTheSpaceIsTheDesignInItsPlace) {
  std::string text = race_of_one();
  const std::string height = "\"lighting.ring.height_mm\" = { min = 20, max = 40 }";
  text.replace(text.find(height),
               height.size(),
               "\"material.roughness\" = { min = 0.1, max = 0.8, step = 0.1 }");
  text.replace(text.find("roughness = 0.5"), 15, "roughness = 0.3");
  EXPECT_EQ(entrants_beside_start(text), (std::set<std::string>{"winner"}));
}

/// -15 + 3 * 5 is 0, but -0.3 + 3 * 0.1 is 5.6e-17.
TEST(SearchRace, ABaselineOfZeroOnAStepIsTheDesignInItsPlace) {
  std::string text = race_of_one();
  const std::string height = "\"lighting.ring.height_mm\" = { min = 20, max = 40 }";
  text.replace(text.find(height),
               height.size(),
               "\"lighting.ring.tilt_deg\" = { min = -0.3, max = 0.5, step = 0.1 }");
  EXPECT_EQ(entrants_beside_start(text), (std::set<std::string>{"winner"}));
}

/// The limit is of a score that noise does not move and that no scan of a winner repeats.
TEST(SearchRace, ChoosesTheWinnerOfANoisySearch) {
  const NoisyRun& run =
      noisy_run(kNoisyRing + "[constraints]\n\"lighting.width_mm\" = { max = 1000 }\n");
  const Json& result = run.result;
  const Json& race = result.at("race");
  EXPECT_EQ(race.at("finalists"), 2);
  double sum = 0.0;
  std::set<std::string> keys;
  const Json* winner = nullptr;
  for (const Json& row : race.at("entrants")) {
    sum += row.at("probability").get<double>();
    keys.insert(row.at("key").get<std::string>());
    winner = row.at("key") == "winner" ? &row : winner;
  }
  EXPECT_NEAR(sum, 1.0, 1e-9);
  ASSERT_NE(winner, nullptr);
  EXPECT_TRUE(keys.contains("low"));
  EXPECT_EQ(winner->at("trial"), result.at("best").at("trial"));
  EXPECT_EQ(winner->at("replicates"), 8);
  EXPECT_GT(winner->at("expected_sd").get<double>(), 0.0);
  EXPECT_EQ(winner->at("limits").at("probability"), 1.0);
  EXPECT_EQ(winner->at("keeps_limits"), true);
  const Json& limits = result.at("best").at("limits");
  EXPECT_EQ(limits.at("by"), "replicates");
  EXPECT_EQ(limits.at("probability"), 1.0);
  EXPECT_NEAR(limits.at("scores").at("lighting.width_mm").at("sd").get<double>(), 0.0, 1e-9);
  EXPECT_EQ(result.at("best").at("feasible"), true);
  EXPECT_THAT(result.at("verdict").at("sentence").get<std::string>(),
              HasSubstr("By its replicates it keeps the constraint with a probability of 100 %."));
  const Storage storage = Storage::read(run.out() / "study.sqlite");
  EXPECT_EQ(race.at("evaluations"), storage.trials(TrialKind::kReplicate).size());
  expect_outcomes_kept(storage, result);
  ASSERT_EQ(result.at("probability_best").size(), race.at("entrants").size());
  const Json& told = result.at("best").at("told");
  EXPECT_LT(told.at("low"), told.at("value"));
  EXPECT_LT(told.at("value"), told.at("high"));
  EXPECT_NE(told.at("value"), told.at("seen"));
}

/// Which a scan alone does not have.
TEST(SearchRace, ReplicatesHaveBoundsOfIntervals) {
  const NoisyRun& run = noisy_run(kNoisyRing +
                                  "[constraints]\n\"defects.min_weber.low\" = { min = -1000 }\n"
                                  "[inspection.trials]\nnoise_seeds = 2\n");
  for (const Json& row : run.result.at("race").at("entrants")) {
    EXPECT_GE(row.at("replicates"), 4) << row.at("key");
    EXPECT_EQ(row.at("keeps_limits"), true) << row.at("key");
  }
}

// As `glint check` predicts it: 10 evaluations are the search, all those of the race are not.
TEST(SearchRace, CountsAsRescoring) {
  const auto search_s = [](const std::string& text) {
    return Json::parse(read_file(noisy_run(text).out() / "run.json"))
        .at("cpu_s")
        .at("search")
        .get<double>();
  };
  EXPECT_LT(search_s(kNoisyRing), 2.0 * search_s(kNoRace));
}

TEST(SearchRace, IsPredictedWhereThereIsOne) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", kNoisyRing);
  // 8 of the winner, 4 of each of 8 finalists and of the prototype.
  EXPECT_EQ(likely_replicates(load_study(folder / "study.toml", {}), 300), 44);
  EXPECT_EQ(likely_replicates(load_study(folder / "study.toml", {{"search.noisy", "false"}}), 300),
            0);
}

TEST(SearchRace, IsToldByTheReport) {
  const Json& result = noisy_run().result;
  const Json data = report_data({noisy_run().out()});
  const auto panel = std::ranges::find(
      data.at("panels"), Json("noise"), [](const Json& one) { return one.at("id"); });
  ASSERT_NE(panel, data.at("panels").end());
  EXPECT_THAT(panel->at("lead").get<std::string>(), HasSubstr("2 finalists raced"));
  EXPECT_THAT(panel->at("lead").get<std::string>(), HasSubstr("the search saw"));
  EXPECT_EQ(panel->at("tables")[0].at("rows").size(), result.at("race").at("entrants").size());
  EXPECT_EQ(data.at("probability_best"), result.at("probability_best"));
  const auto& findings = result.at("verdict").at("findings");
  EXPECT_TRUE(std::ranges::any_of(
      findings, [](const Json& one) { return one.at("code") == "probability_best"; }));
}

TEST(SearchRace, IsLeftOutWithoutNoiseOrWhereItIsNotWanted) {
  const TemporaryFolder folder;
  EXPECT_FALSE(noisy_run(kNoRace).result.contains("race"));
  std::string calm = kNoisyRing;
  calm.replace(calm.find("noisy = true"), 12, "noisy = false");
  EXPECT_FALSE(run_noisy(folder, "calm", calm).contains("race"));
  EXPECT_EQ(run_noisy(folder, "asked", calm + "race = 3\n").at("race").at("finalists"), 3);
}

TEST(JudgeLimits, OfADesignThatRacedIsByItsReplicates) {
  const Goal goal = {.objective = {.name = "gain"},
                     .constraints = {{.name = "glare", .min = {}, .max = 1.0}}};
  const Json limits = {{"probability", 0.3}, {"by", "replicates"}, {"scores", Json::object()}};
  const Json race = {{"entrants",
                      Json::array({{{"key", "dome"}, {"keeps_limits", false}, {"limits", limits}},
                                   {{"key", "bar"}, {"keeps_limits", false}}})}};
  const Json lucky = {{"scores", {{"glare", 0.9}}}};
  const auto judged = [&](const Json& by, const std::string& key) {
    Json design = lucky;
    judge_limits(goal, by, key, design);
    return design;
  };
  EXPECT_EQ(judged(race, "dome").at("feasible"), false);
  EXPECT_EQ(judged(race, "dome").at("limits"), limits);
  EXPECT_EQ(judged(race, "bar").at("feasible"), true) << "a race by rules 7";
  EXPECT_EQ(judged(Json(), "dome").at("feasible"), true);
  Json told = {{"feasible", false}, {"scores", {{"glare", 0.9}}}};
  judge_limits(goal, Json(), "winner", told);
  EXPECT_EQ(told.at("feasible"), false);
  Json without = lucky;
  judge_limits({.objective = {.name = "gain"}, .constraints = {}}, race, "dome", without);
  EXPECT_FALSE(without.contains("feasible"));
}

TEST(NoisePanel, WritesScoresAsTheRestOfThePage) {
  const Json told = {{"score", "homogeneity.h_rms"},
                     {"seen", 0.8112},
                     {"expected", 0.8012},
                     {"expected_sd", 0.004},
                     {"value", 0.7998},
                     {"low", 0.79},
                     {"high", 0.81}};
  EXPECT_EQ(noise_panel("homogeneity.h_rms", Json(), told)["lead"],
            "The winner's h (rms) is 80.0 % (95 %: 79.0 % to 81.0 %) over random numbers that "
            "nothing was chosen by; the search saw 81.1 %, its model expects 80.1 % \u00b1 0.4 "
            "points.");
}

TEST(SearchRace, OfSeveralObjectivesIsRefused) {
  const TemporaryFolder folder;
  std::string text = kNoisyRing + "race = 3\n";
  text.replace(text.find("[objective]"),
               11,
               "[[objective]]\nmaximise = \"homogeneity.h_rms\"\n[[objective]]");
  try {
    run_noisy(folder, "out", text);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("budget.race: works with a single objective"));
  }
}

}  // namespace
}  // namespace glint
