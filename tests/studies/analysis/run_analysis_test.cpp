// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/run_analysis.h"

#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "optimizer/algorithm/sobol.h"
#include "optimizer/storage/storage.h"
#include "studies/accuracy/tried_designs.h"
#include "studies/analysis/fitted_score.h"
#include "studies/run/begun_study.h"
#include "studies/run/run.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

const std::string kSearch = "schema = 1\n" + kPathPlate + kPathRing + R"(
[variables]
"lighting.ring.height_mm" = { min = 20, max = 60 }
"lighting.ring.radiance.0" = { min = 0.5, max = 1.0 }
[objective]
maximise = "homogeneity.mean"
[search]
algorithm = "sobol"
[budget]
evaluations = 6
)";

std::filesystem::path finished_run(const TemporaryFolder& folder, const std::string& text) {
  write_file(folder / "study.toml", text);
  run_study(load_study(folder / "study.toml", {}),
            {.out = folder / "run",
             .threads = 2,
             .jobs = 2,
             .progress = Progress::Style::kNone,
             .log_file = {}});
  return folder / "run";
}

AddOptions added(int count) {
  return {.count = count, .threads = 2, .progress = Progress::Style::kNone};
}

// Brightness grows with the radiance of the one light, and falls with its height.
TEST(RunAnalysis, AddsDesignsUntilTheEvidenceIsEnough) {
  const TemporaryFolder folder;
  const std::filesystem::path run = finished_run(folder, kSearch);
  const std::string trials = read_file(run / "study.sqlite");
  Json analysis = analyse_run(run);
  EXPECT_EQ(analysis["added"], 0);
  EXPECT_FALSE(analysis["scores"][0]["branches"][0]["is_enough"].get<bool>());
  EXPECT_TRUE(analysis["scores"][0]["branches"][0]["importance"].empty());

  EXPECT_EQ(add_designs(run, added(5)), 5);
  const auto first = Storage::read(run / kAddedDesigns).trials(TrialKind::kSearch);
  EXPECT_EQ(add_designs(run, added(5)), 0) << "they are there";
  EXPECT_EQ(add_designs(run, added(24)), 19);
  const auto all = Storage::read(run / kAddedDesigns).trials(TrialKind::kSearch);
  ASSERT_EQ(all.size(), 24U);
  EXPECT_EQ(all[4].point, first[4].point);
  EXPECT_EQ(all[4].outcome->scores, first[4].outcome->scores);

  analysis = analyse_run(run);
  EXPECT_EQ(analysis["added"], 24);
  const Json& branch = analysis["scores"][0]["branches"][0];
  ASSERT_TRUE(branch["is_enough"].get<bool>()) << branch["reason"];
  EXPECT_EQ(branch["points"], 30);
  EXPECT_EQ(branch["importance"].size(), 2U);
  EXPECT_EQ(branch["responses"][1]["variable"], "lighting.ring.radiance.0");
  const Json& bright = branch["responses"][1]["average"];
  EXPECT_GT(bright.back().get<double>(), 1.5 * bright.front().get<double>());
  EXPECT_EQ(read_file(run / "study.sqlite"), trials) << "the run's own trials stay";
}

/// Brightness by height and radiance, of even designs; number 4 is a plain one, and number 10,
/// truly 0.54, was seen brighter than any can be.
std::vector<Trial> bright_trials(const Study& study) {
  const Sobol even(9, 2);
  std::vector<Trial> trials;
  for (std::uint32_t k = 0; k < 36; ++k) {
    Point point = point_from_unit(study.space, even.point(k));
    point = k == 3 ? Point{25.0, 0.7} : k == 9 ? Point{40.0, 0.9} : point;
    const double mean = k == 9 ? 0.82 : point[1] * (1.0 - 0.01 * point[0]);
    Scores scores = {{"homogeneity.mean", mean}};
    for (const Constraint& limit : study.goal.constraints) {
      scores[limit.name] = limit.min.value_or(limit.max.value_or(0.0));  // kept
    }
    trials.push_back({.number = static_cast<int>(k) + 1,
                      .point = point,
                      .outcome = Outcome{.scores = std::move(scores)}});
  }
  return trials;
}

/// The folder of a noisy run with these trials, of which number 4 is its answer; nothing is
/// rendered.
void write_noisy_run(const std::filesystem::path& run, const std::vector<Trial>& trials) {
  Storage storage = Storage::open(run / "study.sqlite", {});
  for (const Trial& trial : trials) {
    storage.append(std::vector<Event>{{.kind = EventKind::kAsk, .trial = trial.number}},
                   std::vector<Trial>{trial});
  }
  write_file(run / "result.json", R"({"schema": 1, "best": {"trial": 4}})");
}

// The responses go through what the run answers, not through what it saw.
TEST(RunAnalysis, UnderNoiseShowsTheRunsOwnAnswer) {
  const TemporaryFolder folder;
  const std::filesystem::path& run = folder.path();
  write_file(run / "study.resolved.toml",
             kSearch.substr(0, kSearch.find("[search]")) +
                 "[search]\nnoisy = true\n[budget]\nevaluations = 36\n");
  const Study study = load_study(run / "study.resolved.toml", {});
  const std::vector<Trial> trials = bright_trials(study);
  write_noisy_run(run, trials);
  const Json analysis = analyse_run(run);
  const Json& branch = analysis.at("scores").at(0).at("branches").at(0);
  ASSERT_TRUE(branch["is_enough"].get<bool>()) << branch["reason"];
  const Json& response = branch.at("responses").at(0);
  const FittedScore fitted = fit_score(study.space, trials, "homogeneity.mean");
  for (const std::size_t k : {0U, 10U, 20U}) {
    const Point through_answer = {response.at("at").at(k).get<double>(), 0.7};
    EXPECT_NEAR(
        response.at("best").at(k).get<double>(), fitted.model.predict(through_answer).mean, 1e-9);
  }
}

/// What a run tells that is rendered by this rung.
void write_rung(const std::filesystem::path& run, const RenderRung& rung) {
  Json result = {{"schema", 1}};
  result["accuracy"]["rung"] = rung.name;
  write_file(run / "result.json", result.dump());
}

// A resumed search may have raised its rung after designs were added.
TEST(RunAnalysis, DesignsOfARungThatTheSearchHasLeftAreEvaluatedAgain) {
  const TemporaryFolder folder;
  const std::filesystem::path& run = folder.path();
  write_file(run / "study.resolved.toml",
             kSearch + "[accuracy]\nkeep = [\"render.method\"]\ntolerance = \"auto\"\n");
  const Study study = load_study(run / "study.resolved.toml", {});
  write_noisy_run(run, bright_trials(study));
  const std::vector<RenderRung> ladder = search_ladder(study);
  write_rung(run, ladder.front());
  EXPECT_EQ(add_designs(run, added(2)), 2);
  EXPECT_EQ(add_designs(run, added(3)), 1);
  const auto coarse = Storage::read(run / kAddedDesigns).trials(TrialKind::kSearch);
  EXPECT_EQ(analyse_run(run)["added"], 3);
  write_rung(run, ladder.back());
  EXPECT_EQ(analyse_run(run)["added"], 0) << "two rungs are not to be mixed";
  EXPECT_EQ(add_designs(run, added(2)), 2);
  EXPECT_EQ(analyse_run(run)["added"], 2);
  EXPECT_EQ(add_designs(run, added(3)), 1);
  EXPECT_EQ(add_designs(run, added(3)), 0);
  const auto fine = Storage::read(run / kAddedDesigns).trials(TrialKind::kSearch);
  EXPECT_EQ(fine[1].point, coarse[1].point);
  EXPECT_NE(fine[1].outcome->scores, coarse[1].outcome->scores);
}

TEST(RunAnalysis, RefusesAFolderWithoutASearch) {
  EXPECT_THROW(analyse_run("/nonexistent/run"), IoError);
  EXPECT_THROW(add_designs("/nonexistent/run", {.count = 3}), IoError);
}

}  // namespace
}  // namespace glint
