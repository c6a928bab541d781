// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/comparison/several_runs.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "studies/report/report.h"
#include "studies/run/comparison/run_comparison.h"
#include "tests/studies/run/rendered_plate.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// The plate with an objective, and what is added to its text.
Study plate_study(const TemporaryFolder& folder, const std::string& text) {
  write_file(folder / "study.toml", text + "[objective]\nmaximise = \"defects.min_cnr\"\n");
  return load_study(folder / "study.toml", {});
}

Json scored_design(const std::string& key, double cnr, const std::string& role) {
  return {{"key", key}, {"title", key}, {"role", role}, {"scores", {{"defects.min_cnr", cnr}}}};
}

/// A run of prototypes: the baseline has 5, the dome 9.
ReportedRun run_of_prototypes(const std::string& folder, const Study& study) {
  return {.folder = folder,
          .study = study,
          .data = {{"objective", {{"name", "defects.min_cnr"}, {"sense", "maximise"}}},
                   {"designs",
                    {scored_design("baseline", 5.0, "baseline"),
                     scored_design("dome", 9.0, "prototype")}}},
          .result = Json::object()};
}

/// A search whose designs are the given ones.
ReportedRun run_of_search(const std::string& folder, const Study& study, const Json& designs) {
  ReportedRun run = run_of_prototypes(folder, study);
  run.data["status"] = "done";
  run.data["trials"] = Json::array();
  run.data["designs"] = designs;
  run.result = {{"evaluations", 9}, {"failed", 0}};
  return run;
}

TEST(SeveralRuns, AreTheBestOfDesignsWithoutASearch) {
  const TemporaryFolder folder;
  const Study study = plate_study(folder, kScene);
  const Json search = Json::array(
      {scored_design("baseline", 1.0, "baseline"), scored_design("winner", 7.0, "winner")});
  const Json data = several_runs(
      {run_of_prototypes("out/a/run", study), run_of_search("out/b/run", study, search)});
  EXPECT_EQ(data["runs"][0]["scores"]["defects.min_cnr"], 9.0);
  EXPECT_EQ(data["runs"][0]["design"], "dome");
  EXPECT_EQ(data["runs"][1]["scores"]["defects.min_cnr"], 7.0);
  EXPECT_FALSE(data["runs"][1].contains("design")) << "a search's winner is the run";
  EXPECT_EQ(
      complete_report(data)["verdict"]["sentence"],
      "Of 2 runs, dome, Plate (a) has the best smallest CNR: 9.00, 2.00 better than Plate (b).");
}

TEST(SeveralRuns, AreNotStoodForByTheBaselineOfASearchThatFoundNothing) {
  const TemporaryFolder folder;
  const Study study = plate_study(folder, kScene);
  const Json nothing = Json::array({scored_design("baseline", 50.0, "baseline")});
  const Json data =
      several_runs({run_of_prototypes("a", study), run_of_search("b", study, nothing)});
  EXPECT_EQ(data["runs"][1]["feasible"], false);
  EXPECT_FALSE(data["runs"][1].contains("scores"));
}

TEST(SeveralRuns, KnowWhatTheirOwnReportsDoubt) {
  const TemporaryFolder folder;
  const Study study = plate_study(folder, kScene);
  Json winner = scored_design("winner", 7.0, "winner");
  winner["feasible"] = true;
  winner["rescored"] = {{"defects.min_cnr", 5.5}};
  ReportedRun lost = run_of_search("b", study, Json::array({winner}));
  lost.data["constraints"] = {{{"name", "defects.min_cnr"}, {"min", 6}}};
  for (int i = 0; i < 5; ++i) {
    lost.data["trials"].push_back({{"number", i},
                                   {"failed", false},
                                   {"feasible", true},
                                   {"objective", 7.0},
                                   {"scores", {{"defects.min_cnr", 7.0}}}});
  }
  const Json data = several_runs({lost, run_of_prototypes("a", study)});
  ASSERT_EQ(data["runs"][0]["doubts"].size(), 2U);
  EXPECT_EQ(data["runs"][0]["doubts"][0]["code"], "objective_flat");
  EXPECT_EQ(data["runs"][0]["doubts"][1]["code"], "limit_lost");
  EXPECT_EQ(data["runs"][0]["constraints"], lost.data["constraints"]);
  EXPECT_TRUE(data["runs"][1]["doubts"].empty());
}

TEST(SeveralRuns, OfTheSameTitleAreToldApartByTheirFolders) {
  const TemporaryFolder folder;
  const Study study = plate_study(folder, kScene);
  const auto titles = [&](const std::vector<std::string>& folders) {
    std::vector<ReportedRun> runs;
    for (const std::string& name : folders) {
      runs.push_back(run_of_prototypes(name, study));
    }
    const Json data = several_runs(std::move(runs));
    std::set<std::string> keys;
    for (const Json& design : data["designs"]) {
      keys.insert(design["key"].get<std::string>());
    }
    EXPECT_EQ(keys.size(), 2 * folders.size()) << "keys are unique";
    std::vector<std::string> all;
    for (const Json& run : data["runs"]) {
      all.push_back(run["title"].get<std::string>());
    }
    return all;
  };
  EXPECT_THAT(titles({"out/a/run", "out/b/run/"}),
              ::testing::ElementsAre("Plate (a)", "Plate (b)"));
  EXPECT_THAT(titles({"out/first", "out/second"}),
              ::testing::ElementsAre("Plate (first)", "Plate (second)"));
  EXPECT_THAT(titles({"x/a/run", "y/a/run", "y/b/run"}),
              ::testing::ElementsAre("Plate (x/a/run)", "Plate (y/a/run)", "Plate (b)"));
}

// The first varies the roughness: it is comparable with either of the others, these are not.
TEST(SeveralRuns, AreOfOneGroupWhereAllAreComparable) {
  const TemporaryFolder folder;
  const std::string scene = kScene;
  const std::string varied =
      scene + "[variables]\n\"material.roughness\" = { min = 0.1, max = 0.5 }\n";
  std::vector<ReportedRun> runs;
  for (const std::string& text :
       {varied, scene, replaced(scene, "roughness = 0.3", "roughness = 0.2"), scene}) {
    runs.push_back(
        run_of_prototypes("run " + std::to_string(runs.size()), plate_study(folder, text)));
  }
  const Json data = several_runs(std::move(runs));
  EXPECT_EQ(data["runs"][0]["group"], 0);
  EXPECT_EQ(data["runs"][1]["group"], 0);
  EXPECT_EQ(data["runs"][2]["group"], 2);
  EXPECT_EQ(data["runs"][3]["group"], 0);
}

TEST(Comparable, AreStudiesWhoseScoresAreOfOneScale) {
  const TemporaryFolder folder;
  const TemporaryFolder other_folder;
  const std::string scene = kScene;
  const auto is_alike = [&](const std::string& one, const std::string& other) {
    return is_comparable(plate_study(folder, one), plate_study(other_folder, other));
  };
  EXPECT_TRUE(is_alike(scene, scene));
  EXPECT_TRUE(is_alike(scene, replaced(scene, "radiance = [0.5]", "radiance = [0.9]")));
  EXPECT_TRUE(is_alike(scene, replaced(scene, "exposure = 0.7", "exposure = 0.3")));
  EXPECT_FALSE(is_alike(scene, replaced(scene, "roughness = 0.3", "roughness = 0.2")));
  EXPECT_FALSE(is_alike(scene, replaced(scene, "bits = 0", "bits = 8")));
  EXPECT_FALSE(is_alike(scene, scene + "[metrics]\nerosion_px = 5\n"));
  EXPECT_FALSE(is_alike(scene, scene + "[inspection]\npolarity = \"bright\"\n"));
  const std::string varied =
      scene + "[variables]\n\"material.roughness\" = { min = 0.1, max = 0.5 }\n";
  EXPECT_TRUE(is_alike(varied, replaced(scene, "roughness = 0.3", "roughness = 0.2")));
}

// Prices are the scale of costs, and of no CNR; so are the limits of incidence of a coverage.
TEST(Comparable, AreStudiesWhoseObjectivesAreMeasuredByTheSame) {
  const TemporaryFolder folder;
  const auto study = [&](const std::string& tables, const std::string& objective) {
    write_file(folder / "study.toml", kScene + tables + "[objective]\n" + objective);
    return load_study(folder / "study.toml", {});
  };
  const auto is_alike =
      [&](const std::string& one, const std::string& other, const std::string& objective) {
        return is_comparable(study(one, objective), study(other, objective));
      };
  const std::string cheap = "[cost]\nper_mm2 = 0.01\n";
  const std::string dear = "[cost]\nper_mm2 = 0.03\n";
  EXPECT_TRUE(is_alike(cheap, cheap, "minimise = \"cost.total\"\n"));
  EXPECT_FALSE(is_alike(cheap, dear, "minimise = \"cost.total\"\n"));
  EXPECT_TRUE(is_alike(cheap, dear, "maximise = \"defects.min_cnr\"\n"));
  const std::string steep = "[coverage]\nmax_incidence_deg = 70\n";
  const std::string flat = "[coverage]\nmax_incidence_deg = 40\n";
  EXPECT_FALSE(is_alike(steep, flat, "maximise = \"coverage.c1\"\n"));
  EXPECT_TRUE(is_alike(steep, flat, "maximise = \"defects.min_cnr\"\n"));
}

}  // namespace
}  // namespace glint
