// SPDX-License-Identifier: GPL-3.0-or-later
//
// [accuracy] in small runs: of a mirror under a tunnel and of a path-traced plate.
#include "studies/accuracy/chosen_accuracy.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "studies/run/check_study.h"
#include "studies/run/run.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/studies/run/rendered_plate.h"
#include "tests/studies/run/small_tunnel.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

const std::string kPathStudy = "schema = 1\n" + kPathPlate + kPathRing + R"(
[render]
method = "paths"
[variables]
"lighting.ring.height_mm" = { min = 20, max = 60 }
"lighting.ring.inner_radius_mm" = { min = 5, max = 20 }
[objective]
maximise = "defects.min_weber"
[search]
algorithm = "random"
[budget]
evaluations = 14
)";

const std::string kTunnelStudy = test::kSmallTunnelStudy + "evaluations = 10\n";

const std::string kAuto = "[accuracy]\ntolerance = \"auto\"\n";

Study study_from(const TemporaryFolder& folder, const std::string& text) {
  write_file(folder / "study.toml", text);
  return load_study(folder / "study.toml", {});
}

struct Hurry {
  int threads = 2;
  int jobs = 2;
  const std::atomic<int>* interrupt = nullptr;
};

Json run_into(const TemporaryFolder& folder,
              const std::string& text,
              const std::string& name,
              const Hurry& hurry = {}) {
  return run_study(study_from(folder, text),
                   {.out = folder / name,
                    .threads = hurry.threads,
                    .jobs = hurry.jobs,
                    .progress = Progress::Style::kNone,
                    .log_file = {},
                    .interrupt = hurry.interrupt,
                    .from = {}});
}

std::vector<Trial> ladder_trials(const std::filesystem::path& run) {
  return Storage::read(run / kAccuracyTrials).trials(TrialKind::kPart);
}

void expect_same_files(const std::filesystem::path& a, const std::filesystem::path& b) {
  for (const char* name : {"result.json", "trials.csv", "winner/scores.json"}) {
    EXPECT_EQ(read_file(a / name), read_file(b / name)) << name;
  }
}

TEST(RunAccuracy, WithoutTheTableNothingIsTried) {
  const TemporaryFolder folder;
  const Json result = run_into(folder, kTunnelStudy, "out");
  EXPECT_FALSE(result.contains("accuracy"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / kAccuracyTrials));
}

// The design as it is built exactly is the one of the search, rendered alike.
TEST(RunAccuracy, BuiltDesignsAreRenderedAsTheSearch) {
  const TemporaryFolder folder;
  const std::string built =
      kTunnelStudy + kAuto + "[manufacture]\n\"lighting.tunnel.duty\" = { plus_minus = 0.01 }\n";
  const Json result = run_into(folder, built, "out");
  const auto best = static_cast<std::size_t>(result["best"]["trial"].get<int>() - 1);
  const std::vector<Trial> trials =
      Storage::read(folder / "out/study.sqlite").trials(TrialKind::kSearch);
  const double searched = trials[best].outcome->scores.at("homogeneity.h_rms");
  EXPECT_NE(searched, result["best"]["scores"]["homogeneity.h_rms"]) << "rendered otherwise";
  EXPECT_EQ(searched, result["manufacture"]["scores"]["homogeneity.h_rms"]["nominal"]);
}

TEST(RunAccuracy, ATunnelIsSearchedByTheCheapestRungThatServes) {
  const TemporaryFolder folder;
  const Json accuracy = run_into(folder, kTunnelStudy + kAuto, "out")["accuracy"];
  EXPECT_EQ(accuracy["level"], "level 0");
  EXPECT_EQ(accuracy["reached"], true);
  EXPECT_EQ(accuracy["designs"].size(), 12U);
  EXPECT_EQ(accuracy["designs"][0], "baseline");
  EXPECT_EQ(accuracy["not_modelled"].size(), 4U) << "what does not occur is told, too";
  EXPECT_THAT(accuracy["sentence"].get<std::string>(), HasSubstr("Kendall's tau"));
  const double search = accuracy["work"]["search"];
  EXPECT_LT(search, accuracy["work"]["full"].get<double>());
  EXPECT_GT(accuracy["check"]["checked"], 0);
  EXPECT_THAT(read_file(folder / "out/report.html"), HasSubstr("How exactly it was rendered"));
}

// Whole frames, the top, have no derivatives; what the trial knows of a design has none either.
TEST(RunAccuracy, ASearchByDerivativesIsOnlyComparedWithTheTop) {
  const TemporaryFolder folder;
  const std::string by_slsqp = replaced(kTunnelStudy, "\"random\"", "\"slsqp\"");
  const Json accuracy = run_into(folder, by_slsqp + kAuto, "out")["accuracy"];
  const Json& rungs = accuracy["rungs"];
  EXPECT_EQ(rungs.back()["for_search"], false);
  EXPECT_EQ(rungs.back()["tried"], true);
  EXPECT_NE(accuracy["rung"], rungs.back()["name"]);
  for (std::size_t i = 0; i + 1 < rungs.size(); ++i) {
    EXPECT_EQ(rungs[i]["for_search"], true) << rungs[i]["name"];
  }
  const std::vector<Trial> trials =
      Storage::read(folder / "out/study.sqlite").trials(TrialKind::kSearch);
  ASSERT_FALSE(trials.empty());
  EXPECT_EQ(trials.front().outcome->gradients.at("homogeneity.h_rms").size(), 2U);
}

TEST(RunAccuracy, PathsAreTakenAsExactlyAsAskedFor) {
  const TemporaryFolder folder;
  const auto samples = [&](const std::string& tolerance, const std::string& name) -> int {
    const std::string text =
        replaced(kPathStudy, "samples = 8", "samples = 16") +
        "[accuracy]\nkeep = [\"render.method\"]\ntolerance = { \"homogeneity.mean\" = " +
        tolerance + " }\n";
    const Json accuracy = run_into(folder, text, name)["accuracy"];
    EXPECT_EQ(accuracy["scores"][0]["score"], "homogeneity.mean");
    EXPECT_EQ(accuracy["reached"].get<bool>(),
              accuracy["scores"][0]["bound"].get<double>() <=
                  accuracy["scores"][0]["tolerance"].get<double>());
    return accuracy["settings"]["samples"];
  };
  EXPECT_EQ(samples("\"50 %\"", "loose"), 8);
  EXPECT_EQ(samples("1e-9", "tight"), 64) << "the top, of which the bound is told";
  const Json tight = Json::parse(read_file(folder / "tight/result.json"))["accuracy"];
  EXPECT_EQ(tight["reached"], false);
  EXPECT_THAT(tight["unreached"][0].get<std::string>(), HasSubstr("is not reachable"));
}

TEST(RunAccuracy, SaysThatARaceHadTheLastWord) {
  const TemporaryFolder folder;
  const Json result = run_into(folder, kPathStudy + "race = 2\n" + kAuto, "raced");
  const Json& check = result.at("accuracy").at("check");
  EXPECT_EQ(check.at("raced"), result.at("best").at("trial"));
  EXPECT_THAT(check.at("sentence").get<std::string>(), HasSubstr("by a race of the finalists"));
  const Json without = run_into(folder, kPathStudy + kAuto, "without");
  EXPECT_TRUE(without.at("accuracy").at("check").at("raced").is_null());
}

TEST(RunAccuracy, SamplesSetByHandAreTheMostOfTheSearch) {
  const TemporaryFolder folder;
  const std::string text = replaced(kPathStudy, "samples = 8", "samples = 16") +
                           "[accuracy]\ntolerance = { \"homogeneity.mean\" = 1e-9 }\n";
  const Json accuracy = run_into(folder, text, "out")["accuracy"];
  EXPECT_EQ(accuracy["settings"]["samples"], 16);
  EXPECT_EQ(accuracy["rungs"].back()["name"], "2 reflections, 64 samples");
  EXPECT_EQ(accuracy["rungs"].back()["for_search"], false);
}

TEST(RunAccuracy, IsTheSameForAnyNumberOfThreadsAndJobs) {
  const TemporaryFolder folder;
  for (const std::string& text : {kPathStudy, kTunnelStudy}) {
    const std::string name = text == kPathStudy ? "paths" : "tunnel";
    const std::string whole =
        replaced(text, "[objective]", "[accuracy]\nkeep = []\ntolerance = \"auto\"\n[objective]");
    run_into(folder, whole, name + "1", {.threads = 1, .jobs = 1});
    run_into(folder, whole, name + "2", {.threads = 2, .jobs = 2});
    run_into(folder, whole, name + "7", {.threads = 7, .jobs = 3});
    expect_same_files(folder / (name + "1"), folder / (name + "2"));
    expect_same_files(folder / (name + "1"), folder / (name + "7"));
  }
}

// As after a kill: some evaluations of the ladder are recorded, others are not. What is recorded is
// taken as it is, so that a resumed run cannot choose otherwise.
TEST(RunAccuracy, GoesOnFromAnyRecordedPartToTheSameResult) {
  const TemporaryFolder folder;
  const std::string text = kPathStudy + "[accuracy]\nkeep = []\ntolerance = \"auto\"\n";
  run_into(folder, text, "whole");
  const std::vector<Trial> trials = ladder_trials(folder / "whole");
  ASSERT_GT(trials.size(), 20U);
  for (const std::size_t kept : {std::size_t{1}, std::size_t{13}, trials.size() - 1}) {
    const std::string name = "part" + std::to_string(kept);
    std::filesystem::create_directory(folder / name);
    const StudyIdentity identity = Storage::read(folder / "whole" / kAccuracyTrials).identity();
    {
      Storage record = Storage::open(folder / name / kAccuracyTrials, identity);
      for (std::size_t i = 0; i < kept; ++i) {
        record.put_trial(trials[i]);
      }
      Storage::open(folder / name / "study.sqlite", identity);
    }
    run_into(folder, text, name);
    expect_same_files(folder / "whole", folder / name);
  }
}

TEST(RunAccuracy, AnInterruptKeepsWhatWasTried) {
  const TemporaryFolder folder;
  const std::string text = kPathStudy + "[accuracy]\nkeep = []\ntolerance = \"auto\"\n";
  const std::atomic<int> interrupt = 1;
  const Json stopped = run_into(folder, text, "out", {.interrupt = &interrupt});
  EXPECT_EQ(stopped["status"], "interrupted");
  EXPECT_FALSE(stopped.contains("accuracy"));
  run_into(folder, text, "whole");
  run_into(folder, text, "out");
  expect_same_files(folder / "whole", folder / "out");
}

/// A larger picture, of which half resolution is the cheapest rung.
std::string half_study() {
  return replaced(replaced(replaced(kPathStudy, "width_px = 48", "width_px = 96"),
                           "height_px = 32",
                           "height_px = 64"),
                  "object_pixel_mm = 0.2",
                  "object_pixel_mm = 0.1") +
         "[accuracy]\nkeep = []\ntolerance = { \"defects.min_weber\" = 1.0 }\n";
}

// All trials: those that the trial of the ladder knew, and those that the search evaluated.
TEST(RunAccuracy, ASearchAtHalfResolutionTakesScoresLessTheirMeanErrors) {
  const TemporaryFolder folder;
  const Json accuracy = run_into(folder, half_study(), "out")["accuracy"];
  ASSERT_EQ(accuracy["level"], "half resolution") << accuracy["rung"];
  const double offset = accuracy["offsets"]["defects.min_weber"];
  EXPECT_NE(offset, 0.0);
  const Study study = study_from(folder, half_study());
  ThreadPool pool(2);
  SceneStore store(pool);
  const std::optional<SearchRungs> rungs = rungs_of_run(study, folder / "out");
  ASSERT_TRUE(rungs.has_value());
  const std::vector<Trial> trials =
      Storage::read(folder / "out/study.sqlite").trials(TrialKind::kSearch);
  ASSERT_EQ(trials.size(), 14U);
  for (const Trial& trial : trials) {
    const Outcome raw =
        evaluate_at(store, study, overrides_of(study, trial.point), rungs->of(trial.point));
    EXPECT_DOUBLE_EQ(trial.outcome->scores.at("defects.min_weber"),
                     raw.scores.at("defects.min_weber") - offset)
        << trial.number;
  }
}

TEST(RunAccuracy, HalfResolutionIsTheSameForAnyNumberOfThreadsAndInDesignsAsBuilt) {
  const TemporaryFolder folder;
  const std::string text =
      half_study() + "[manufacture]\n\"lighting.ring.height_mm\" = { plus_minus = 0.5 }\n";
  const Json result = run_into(folder, text, "one", {.threads = 1, .jobs = 1});
  run_into(folder, text, "three", {.threads = 3, .jobs = 3});
  expect_same_files(folder / "one", folder / "three");
  const auto best = static_cast<std::size_t>(result["best"]["trial"].get<int>() - 1);
  const std::vector<Trial> trials =
      Storage::read(folder / "one/study.sqlite").trials(TrialKind::kSearch);
  EXPECT_DOUBLE_EQ(trials[best].outcome->scores.at("defects.min_weber"),
                   result["manufacture"]["scores"]["defects.min_weber"]["nominal"].get<double>());
}

TEST(RunAccuracy, CheckSaysTheSameBefore) {
  const TemporaryFolder folder;
  const std::string text = kPathStudy + "[accuracy]\nkeep = []\ntolerance = \"auto\"\n";
  const Json before = check_study(study_from(folder, text), {.threads = 2, .jobs = 2})["accuracy"];
  const Json after = run_into(folder, text, "out")["accuracy"];
  EXPECT_EQ(before["rung"], after["rung"]);
  EXPECT_EQ(before["rungs"], after["rungs"]);
  EXPECT_EQ(before["sentence"], after["sentence"]);
}

TEST(RunAccuracy, RefusesWhatContradictsItBeforeAFolderIsMade) {
  const TemporaryFolder folder;
  const std::string text =
      kTunnelStudy + kAuto + "[render]\nmethod = \"auto\"\nmax_direction_error_mrad = 0.2\n";
  try {
    run_into(folder, text, "out");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("leaves one way to render"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  EXPECT_THROW(check_accuracy_choice(study_from(folder, kTunnelStudy + kAuto), true), ConfigError);
}

/// A polished cylinder under a tunnel, or under a ring, whose light is sampled.
const std::string kTwoKinds =
    replaced(test::kSmallTunnel, "schema = 1\n", "schema = 1\nlighting_use = \"ring\"\n") +
    kPathRing + R"([sensor]
blur_px = 0
[render.paths]
samples = 8
batches = 4
max_reflections = 1
[variables]
lighting_use = { choices = ["tunnel", "ring"] }
"sensor.gain" = { min = 0.5, max = 2 }
[objective]
maximise = "homogeneity.mean"
[search]
algorithm = "random"
[budget]
evaluations = 6
[accuracy]
tolerance = { "homogeneity.mean" = 0.5 }
)";

// glint check says before what the run does, and what the run tells is what it did.
TEST(RunAccuracy, EachKindOfLightHasARungOfItsOwn) {
  const TemporaryFolder folder;
  const Json branches = run_into(folder, kTwoKinds, "out")["accuracy"]["branches"];
  ASSERT_EQ(branches.size(), 2U);
  EXPECT_EQ(branches[0]["level"], "level 0");
  EXPECT_EQ(branches[1]["rung"], "direct light, 8 samples");
  const Study study = study_from(folder, kTwoKinds);
  const std::optional<SearchRungs> rungs = rungs_of_run(study, folder / "out");
  ASSERT_TRUE(rungs.has_value());
  ThreadPool pool(2);
  SceneStore store(pool);
  for (const Trial& trial : Storage::read(folder / "out/study.sqlite").trials(TrialKind::kSearch)) {
    const RenderRung& rung = rungs->of(trial.point);
    const Overrides overrides = overrides_of(study, trial.point);
    EXPECT_EQ(trial.outcome->scores.at("homogeneity.mean"),
              evaluate_at(store, study, overrides, rung).scores.at("homogeneity.mean"))
        << trial.number << " by " << rung.name;
  }
  const Json before = check_study(study, {.threads = 2, .jobs = 2})["accuracy"]["branches"];
  for (std::size_t i = 0; i < branches.size(); ++i) {
    EXPECT_EQ(before[i]["rung"], branches[i]["rung"]);
    EXPECT_EQ(before[i]["scores"], branches[i]["scores"]);
  }
}

}  // namespace
}  // namespace glint
