// SPDX-License-Identifier: GPL-3.0-or-later
//
// A run with two objectives: its JSON, its report and that it goes on.
#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "optimizer/front/front.h"
#include "optimizer/storage/storage.h"
#include "studies/run/run.h"
#include "studies/run/run_report.h"
#include "tests/studies/run/rendered_plate.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

constexpr const char* kTinyTunnel = R"(schema = 1
[camera]
width_px = 64
height_px = 32
object_pixel_mm = 1
[part]
length_mm = 60
width_mm = 30
[scan]
positions = 4
[defects.dent]
x_mm = [5]
y_mm = [2]
diameter_mm = 8
height_um = 40
[lighting.tunnel]
shape = "semicylinder"
radius_mm = 150
[variables]
"lighting.tunnel.radius_mm" = { min = 120, max = 240 }
"lighting.tunnel.duty" = { min = 0.2, max = 0.8 }
[[objective]]
maximise = "homogeneity.h_rms"
[[objective]]
maximise = "defects.min_cnr"
[constraints]
"homogeneity.clipped_share" = { max = 1 }
[budget]
evaluations = 12
)";

Json run_into(const TemporaryFolder& folder, const std::string& name, int evaluations) {
  write_file(folder / "study.toml", kTinyTunnel);
  const Study study =
      load_study(folder / "study.toml", {{"budget.evaluations", std::to_string(evaluations)}});
  return run_study(study,
                   {.out = folder / name,
                    .threads = 2,
                    .jobs = 1,
                    .progress = Progress::Style::kNone,
                    .log_file = {}});
}

/// The objectives of a design of the front, smaller is better.
std::vector<double> row_of(const Json& design) {
  return {-design.at("scores").at("homogeneity.h_rms").get<double>(),
          -design.at("scores").at("defects.min_cnr").get<double>()};
}

TEST(FrontRun, TheResultHoldsTheFrontAndTheChosenDesign) {
  const TemporaryFolder folder;
  const Json result = run_into(folder, "out", 12);
  EXPECT_EQ(Json::parse(read_file(folder / "out/result.json")).at("front"), result.at("front"));
  std::vector<std::vector<double>> rows;
  std::vector<int> trials;
  for (const Json& design : result.at("front")) {
    rows.push_back(row_of(design));
    trials.push_back(design.at("trial"));
    EXPECT_EQ(design.at("variables").size(), 2U);
    EXPECT_TRUE(design.at("scores").contains("homogeneity.clipped_share"));
    EXPECT_TRUE(design.at("errors").is_object());
  }
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(front_of(rows).size(), rows.size());
  const Json& reference = result.at("reference");
  const std::vector<double> at = {-reference.at("homogeneity.h_rms").get<double>(),
                                  -reference.at("defects.min_cnr").get<double>()};
  EXPECT_DOUBLE_EQ(result.at("hypervolume").get<double>(), hypervolume(rows, at));
  const Json& chosen = result.at("chosen");
  EXPECT_EQ(std::ranges::count(trials, chosen.at("trial").get<int>()), 1);
  EXPECT_EQ(result.at("best").at("trial"), chosen.at("trial"));
  EXPECT_FALSE(chosen.at("reason").get<std::string>().empty());
  EXPECT_THAT(result.at("verdict").at("sentence").get<std::string>(),
              HasSubstr("The compromise reaches "));
  double sum = 0.0;
  for (const Json& one : result.at("probability_best")) {
    sum += one.at("probability").get<double>();
  }
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

/// Of three objectives. Scores of the lighting follow from settings: noise does not move them.
Json noisy_run_into(const TemporaryFolder& folder) {
  const std::string text = std::string(kTinyTunnel) +
                           "[[objective]]\nminimise = \"lighting.width_mm\"\n[search]\nnoisy = "
                           "true\n";
  write_file(folder / "study.toml", text);
  const Study study = load_study(folder / "study.toml", {});
  return run_study(study,
                   {.out = folder / "out",
                    .threads = 2,
                    .jobs = 1,
                    .progress = Progress::Style::kNone,
                    .log_file = {}});
}

TEST(FrontRun, OfNoisyObjectivesTheFrontIsOfWhatTheModelExpects) {
  const TemporaryFolder folder;
  const Json result = noisy_run_into(folder);
  ASSERT_FALSE(result.at("front").empty());
  const std::vector<Trial> trials =
      Storage::read(folder / "out/study.sqlite").trials(TrialKind::kSearch);
  for (const Json& design : result.at("front")) {
    const Json& expected = design.at("expected");
    EXPECT_EQ(expected.size(), 2U);
    EXPECT_FALSE(expected.contains("lighting.width_mm"));
    EXPECT_GT(expected.at("homogeneity.h_rms").at("sd").get<double>(), 0.0);
    EXPECT_GE(design.at("limits").at("probability").get<double>(), 0.5);
    EXPECT_TRUE(design.at("limits").at("scores").contains("homogeneity.clipped_share"));
    const Scores& seen =
        trials[static_cast<std::size_t>(design.at("trial").get<int>() - 1)].outcome->scores;
    for (const char* name : {"homogeneity.h_rms", "defects.min_cnr"}) {
      EXPECT_EQ(design.at("scores").at(name), expected.at(name).at("value"));
      EXPECT_EQ(design.at("searched").at(name).get<double>(), seen.at(name));
    }
    EXPECT_EQ(design.at("scores").at("lighting.width_mm").get<double>(),
              seen.at("lighting.width_mm"));
  }
  EXPECT_THAT(result.at("chosen").at("reason").get<std::string>(), HasSubstr("expected to beat"));
  EXPECT_EQ(result.at("best").at("trial"), result.at("chosen").at("trial"));
  const Json calm = run_into(folder, "calm", 12);
  EXPECT_FALSE(calm.at("front")[0].contains("expected"));
  EXPECT_FALSE(calm.at("front")[0].contains("searched"));
  EXPECT_FALSE(calm.at("front")[0].contains("limits"));
  EXPECT_EQ(result.at("best").at("limits").at("by"), "model");
  EXPECT_FALSE(calm.at("best").contains("limits"));
  EXPECT_FALSE(calm.contains("front_expected"));
}

/// Not by the one evaluation that is written.
TEST(FrontRun, WrittenDesignsOfANoisyFrontKeepLimitsAsTheFrontSays) {
  const TemporaryFolder folder;
  const Json result = noisy_run_into(folder);
  for (const Json& design : result.at("front")) {
    if (design.at("shown") == "full") {
      const Json written = Json::parse(
          read_file(folder / "out" / design.at("folder").get<std::string>() / "scores.json"));
      EXPECT_EQ(written.at("feasible"), true);
      EXPECT_EQ(written.at("limits"), design.at("limits"));
    }
  }
}

/// The database alone tells what was seen.
TEST(FrontRun, TheReportOfANoisyRunHasTheFrontOfTheRun) {
  const TemporaryFolder folder;
  const Json result = noisy_run_into(folder);
  const Json data = report_data({folder / "out"});
  const Json& front = data.at("front");
  EXPECT_EQ(front.at("is_expected"), true);
  ASSERT_EQ(front.at("designs").size(), result.at("front").size());
  for (std::size_t k = 0; k < front.at("designs").size(); ++k) {
    EXPECT_EQ(front.at("designs")[k].at("scores"), result.at("front")[k].at("scores"));
    EXPECT_EQ(front.at("designs")[k].at("searched"), result.at("front")[k].at("searched"));
  }
  EXPECT_EQ(front.at("chosen"), result.at("chosen"));
  EXPECT_EQ(front.at("hypervolume"), result.at("hypervolume"));
  EXPECT_EQ(front.at("history").size(), 12U);
  EXPECT_DOUBLE_EQ(front.at("history").back().get<double>(), front.at("hypervolume").get<double>());
  EXPECT_EQ(front.at("noise_history").back(), Json({12, front.at("noise")}));
  EXPECT_THAT(data.at("verdict").dump(), HasSubstr("front_expected"));
}

TEST(FrontRun, TheReportHasTheFrontWithItsHistory) {
  const TemporaryFolder folder;
  const Json result = run_into(folder, "out", 12);
  const Json front = report_data({folder / "out"}).at("front");
  ASSERT_EQ(front.at("designs").size(), result.at("front").size());
  for (std::size_t k = 0; k < front.at("designs").size(); ++k) {
    Json design = front.at("designs")[k];
    EXPECT_TRUE(design.contains("aspect") != design.contains("thumbnail"));
    EXPECT_THAT(design.at("drawing").get<std::string>(), HasSubstr("<svg"));
    for (const char* picture : {"aspect", "thumbnail", "drawing", "closeups", "notes"}) {
      design.erase(picture);
    }
    EXPECT_EQ(design, result.at("front")[k]);
  }
  EXPECT_EQ(front.at("rescored"), result.at("front_rescored"));
  EXPECT_EQ(front.at("history").size(), 12U);
  EXPECT_DOUBLE_EQ(front.at("history").back().get<double>(), front.at("hypervolume").get<double>());
  EXPECT_EQ(front.at("noise_history").back(), Json({12, front.at("noise")}));
  ASSERT_EQ(front.at("objectives").size(), 2U);
  EXPECT_EQ(front.at("objectives")[1].at("score"), "defects.min_cnr");
  EXPECT_EQ(front.at("objectives")[1].at("direction"), "maximise");
  EXPECT_THROW(report_data({folder / "out", folder / "out"}), ConfigError);
}

/// Every file below a folder with its bytes.
std::map<std::string, std::string> files_in(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files[std::filesystem::relative(entry.path(), folder).string()] = read_file(entry.path());
    }
  }
  return files;
}

TEST(FrontRun, ALargerBudgetGoesOnToTheSameFront) {
  const TemporaryFolder folder;
  const Json whole = run_into(folder, "whole", 14);
  run_into(folder, "cut", 9);
  // A design of a front that is no longer one, and what was never Glint's.
  std::filesystem::create_directories(folder / "cut/front/trial_999");
  write_file(folder / "cut/front/trial_999/scores.json", "{}");
  write_file(folder / "cut/front/notes.txt", "mine");
  const Json resumed = run_into(folder, "cut", 14);
  for (const char* name :
       {"front", "front_rescored", "hypervolume", "reference", "chosen", "probability_best"}) {
    EXPECT_EQ(resumed.at(name), whole.at(name)) << name;
  }
  EXPECT_EQ(read_file(folder / "cut/front/notes.txt"), "mine");
  std::filesystem::remove(folder / "cut/front/notes.txt");
  EXPECT_EQ(files_in(folder / "cut/front"), files_in(folder / "whole/front"));
}

TEST(FrontRun, MembersOfTheFrontAreScoredAgainLikeTheWinner) {
  const TemporaryFolder folder;
  const Json result = run_into(folder, "out", 12);
  int rescored = 0;
  for (const Json& design : result.at("front")) {
    if (design.at("shown") != "full") {
      continue;
    }
    ++rescored;
    const Json written = Json::parse(
        read_file(folder / "out" / design.at("folder").get<std::string>() / "scores.json"));
    for (const char* name : {"homogeneity.h_rms", "defects.min_cnr"}) {
      EXPECT_EQ(design.at("rescored").at(name), written.at("rescored").at(name));
      EXPECT_GE(design.at("rescored_errors").at(name).get<double>(), 0.0);
    }
    EXPECT_NE(design.at("rescored").at("defects.min_cnr"),
              design.at("scores").at("defects.min_cnr"))
        << "fresh seeds";
    EXPECT_TRUE(design.at("keeps_limits").is_boolean());
  }
  EXPECT_GT(rescored, 0);
  const Json& summary = result.at("front_rescored");
  EXPECT_EQ(summary.at("designs"), rescored);
  // The chosen one is the winner, which is scored as ever; the others once, and in 8 scans.
  EXPECT_EQ(summary.at("evaluations"), 9 * (rescored - 1));
  EXPECT_EQ(result.at("evaluations"), 12) << "the search's budget does not count them";
  EXPECT_TRUE(
      Json::parse(read_file(folder / "out/run.json")).at("cpu_s").contains("of_these_front"));
}

TEST(FrontRun, TolerancesSpreadEveryObjective) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             std::string(kTinyTunnel) +
                 "[manufacture]\n\"lighting.tunnel.slot_mm\" = { plus_minus = 0.5 }\n");
  const Json result = run_study(load_study(folder / "study.toml", {}),
                                {.out = folder / "out",
                                 .threads = 2,
                                 .jobs = 1,
                                 .progress = Progress::Style::kNone,
                                 .log_file = {}});
  const Json& scores = result.at("manufacture").at("scores");
  EXPECT_TRUE(scores.contains("homogeneity.h_rms"));
  EXPECT_TRUE(scores.contains("defects.min_cnr"));
}

/// Two prototypes are all that could be compared.
TEST(FrontRun, WithoutAFeasibleDesignItEndsWithItsReport) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             replaced(kTinyTunnel,
                      "[constraints]\n",
                      "[prototypes.wide]\n\"lighting.tunnel.radius_mm\" = 200\n"
                      "[prototypes.narrow]\n\"lighting.tunnel.radius_mm\" = 130\n"
                      "[constraints]\n\"homogeneity.h_rms\" = { min = 1000 }\n"));
  const Study study = load_study(folder / "study.toml", {{"budget.evaluations", "4"}});
  const Json result = run_study(study,
                                {.out = folder / "run",
                                 .threads = 2,
                                 .jobs = 1,
                                 .progress = Progress::Style::kNone,
                                 .log_file = {}});
  EXPECT_EQ(result["status"], "no_feasible");
  EXPECT_TRUE(result["front"].empty());
  EXPECT_TRUE(result["chosen"].is_null());
  EXPECT_FALSE(result.contains("probability_best"));
  EXPECT_EQ(result["prototypes"].size(), 2U);
  EXPECT_TRUE(std::filesystem::exists(folder / "run/report.html"));
}

}  // namespace
}  // namespace glint
