// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/run_analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "optimizer/storage/storage.h"
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

TEST(RunAnalysis, RefusesAFolderWithoutASearch) {
  EXPECT_THROW(analyse_run("/nonexistent/run"), IoError);
  EXPECT_THROW(add_designs("/nonexistent/run", {.count = 3}), IoError);
}

}  // namespace
}  // namespace glint
