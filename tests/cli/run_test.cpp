// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint run` from the study file to the files of the run directory.
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/studies/evaluation/covered_plate.h"
#include "tests/studies/reference/photographed_plate.h"
#include "tests/support/page_data.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;

using ::testing::HasSubstr;

Arguments run_arguments(const std::string& out, const Arguments& more = {}) {
  Arguments arguments = {"run", "study.toml", "--quiet", "--json", "--out", out};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

void run_ok(const TemporaryFolder& folder, const std::string& out, const Arguments& more = {}) {
  const ProgramResult result = glint_in(folder, run_arguments(out, more));
  ASSERT_EQ(result.code, 0) << result.err;
}

TEST(GlintRun, WritesTheRunDirectory) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", mixed_study());
  run_ok(folder, "out/run");
  for (const std::string name : {"run.json",
                                 "result.json",
                                 "study.resolved.toml",
                                 "study.sqlite",
                                 "trials.csv",
                                 "report.html",
                                 "log.txt"}) {
    EXPECT_TRUE(fs::is_regular_file(folder / "out/run" / name)) << name;
  }
  for (const std::string design : {"baseline", "winner", "wide", "ellipse"}) {
    for (const std::string name : {"scene.toml",
                                   "sequence/frame_000.png",
                                   "sequence/frame_007.png",
                                   "aspect.png",
                                   "aspect.exr",
                                   "part_mask.png",
                                   "defects.json",
                                   "scores.json",
                                   "cross_section.svg",
                                   "cross_section.dxf",
                                   "cross_section.csv"}) {
      EXPECT_TRUE(fs::is_regular_file(folder / "out/run" / design / name)) << design << " " << name;
    }
    EXPECT_FALSE(fs::exists(folder / "out/run" / design / "sequence/frame_008.png"));
  }
  const Json run = Json::parse(read_file(folder / "out/run/run.json"));
  for (const std::string key : {"version",
                                "compiler",
                                "isa",
                                "machine",
                                "libraries",
                                "seed",
                                "timings",
                                "cpu_s",
                                "configuration"}) {
    EXPECT_TRUE(run.contains(key)) << key;
  }
  for (const std::string part : {"search", "rescoring", "writing"}) {
    EXPECT_GT(run["cpu_s"][part], 0.0) << part;
  }
}

TEST(GlintRun, GoesOnUnderAnotherTitle) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  run_ok(folder, "out", {"--set", "title=First"});
  const std::string trials = read_file(folder / "out/trials.csv");
  run_ok(folder, "out", {"--set", "title=Second"});
  EXPECT_EQ(read_file(folder / "out/trials.csv"), trials);
  EXPECT_THAT(read_file(folder / "out/study.resolved.toml"), HasSubstr("title = \"Second\""));
  EXPECT_THAT(read_file(folder / "out/report.html"), HasSubstr("Second"));
  EXPECT_EQ(Json::parse(read_file(folder / "out/run.json"))["timings"]["replayed_evaluations"], 12);
}

TEST(GlintRun, SaysWhatEndsIt) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  const ProgramResult both =
      glint_in(folder, {"run", "study.toml", "--out", "a", "--budget", "8h"});
  EXPECT_EQ(both.code, 0);
  EXPECT_THAT(
      both.err,
      HasSubstr("the search ends after 12 evaluations (budget.evaluations) or after 8:00:00 "
                "of searching (budget.wall_clock or --budget), whichever comes first"));
  EXPECT_THAT(both.out, HasSubstr("12 evaluations, 0 failed; ended by budget.evaluations\n"));
  const ProgramResult time = glint_in(
      folder,
      {"run", "study.toml", "--out", "b", "--budget", "1", "--set", "budget.evaluations=1000000"});
  EXPECT_THAT(time.out, HasSubstr("; ended by budget.wall_clock\n"));
}

TEST(GlintRun, PrintsOneJsonObjectAsTheInterfacesSay) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", mixed_study());
  const ProgramResult printed = glint_in(folder, run_arguments("out"));
  EXPECT_EQ(printed.code, 0);
  EXPECT_EQ(printed.err, "");
  const Json result = Json::parse(printed.out);  // throws when anything follows the object
  EXPECT_EQ(result["schema"], 1);
  EXPECT_EQ(result["status"], "done");
  EXPECT_EQ(result["evaluations"], 12);
  EXPECT_EQ(result["failed"], 0);
  EXPECT_EQ(result["report"], "out/report.html");
  EXPECT_GE(result["best"]["trial"], 1);
  EXPECT_EQ(result["best"].size(), 3U) << "no path and no time";
  EXPECT_TRUE(result["best"]["variables"].contains("lighting.tunnel.shape"));
  EXPECT_EQ(result["baseline"]["variables"]["lighting.tunnel.radius_mm"], 80.0);
  const double best = result["best"]["scores"]["homogeneity.h_rms"];
  const double baseline = result["baseline"]["scores"]["homogeneity.h_rms"];
  EXPECT_GE(best, baseline);
  EXPECT_TRUE(result["rescored"]["best"].contains("homogeneity.h_rms"));
  EXPECT_NE(result["rescored"]["baseline"]["homogeneity.h_rms"], baseline);
  EXPECT_TRUE(result["prototypes"]["wide"]["scores"].contains("homogeneity.h_rms"));
  // The file holds the same object; its report stands beside it, wherever the folder is.
  Json file = Json::parse(read_file(folder / "out/result.json"));
  EXPECT_EQ(file["report"], "report.html");
  file["report"] = result["report"];
  EXPECT_EQ(file, result);
}

TEST(GlintRun, TextNamesWinnerAndReport) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  const ProgramResult printed = glint_in(folder, {"run", "study.toml"});
  EXPECT_EQ(printed.code, 0);
  const std::string name = folder.path().filename().string();
  EXPECT_THAT(
      printed.out,
      ::testing::StartsWith("done: 12 evaluations, 0 failed; ended by budget.evaluations\n"));
  EXPECT_THAT(printed.out, ::testing::HasSubstr("winner (trial "));
  EXPECT_THAT(printed.out, ::testing::EndsWith("report: out/" + name + "/run/report.html\n"));
  EXPECT_THAT(printed.err, ::testing::HasSubstr("12/12"));
}

// A reader of a mailed file knows what was simulated, and nothing of the sender's folders.
TEST(GlintRun, ReportSaysWhatWasSimulatedAndNamesNoFolder) {
  const TemporaryFolder folder;
  write_file(folder / "plate.stl", rectangle_stl(40, 12));
  write_file(
      folder / "study.toml",
      edited(small_study(),
             {{"shape = \"strip\"\nlength_mm = 40\nwidth_mm = 12\n", "file = \"plate.stl\"\n"},
              {"radius_along_mm = 400\nradius_across_mm = 40\n", ""},
              {"\"defects.min_cnr\" = { min = 0.1 }\n", ""}}));
  ASSERT_EQ(glint_in(folder, run_arguments("out")).code, 1) << "a flat mirror sees the slot";
  const std::string page = read_file(folder / "out/report.html");
  EXPECT_EQ(page.find(folder.path().string()), std::string::npos);
  EXPECT_NE(read_file(folder / "out/study.resolved.toml").find(folder.path().string()),
            std::string::npos)
      << "the folder itself must be resumed";
  EXPECT_THAT(page, ::testing::ContainsRegex("<span id=\"when\">20[0-9-]* [0-9:]* UTC, [0-9]"));
  const Json data = page_data(page);
  std::map<std::string, std::string> facts;
  for (const Json& fact : data["scene"]["facts"]) {
    facts[fact[0]] = fact[1];
  }
  EXPECT_EQ(facts["Part"], "plate.stl, 40 x 12 x 0 mm, 2 triangles");
  EXPECT_EQ(facts["Surface"], "mirror");
  EXPECT_EQ(facts["Camera"], "200 x 60 px of 0.2 mm on the part, 300 mm away, 8 bits");
  EXPECT_THAT(facts["Light"],
              ::testing::StartsWith("tunnel, semicylinder, 160 mm wide, up to 80 mm"));
  EXPECT_EQ(facts["Study file"], "study.toml");
  const Json& defects = data["scene"]["defects"]["rows"];
  ASSERT_EQ(defects.size(), 1U);
  EXPECT_EQ(defects[0][2], "1.5 mm wide, 4 \u00b5m deep");
  EXPECT_EQ(defects[0][4], "2, 1, 0");
  EXPECT_EQ(data["scene"]["marks"].size(), 1U);
  EXPECT_GT(data["scene"]["picture"].get<std::string>().size(), 1000U);
  const Json& closeup = data["designs"][0]["closeups"][0];
  EXPECT_NEAR(closeup["pixel_mm"].get<double>(), 0.2, 1e-6);
  EXPECT_EQ(closeup["picture"], "mean image");
  EXPECT_LT(closeup["low"].get<double>(), closeup["high"].get<double>());
}

TEST(GlintRun, AgainGivesTheSameAtOnce) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", mixed_study());
  const ProgramResult first = glint_in(folder, run_arguments("out"));
  const auto files = files_below(folder / "out");
  const std::string report = read_file(folder / "out/report.html");
  const ProgramResult second = glint_in(folder, run_arguments("out"));
  EXPECT_EQ(second.code, 0);
  EXPECT_EQ(second.out, first.out);
  const std::string again = read_file(folder / "out/report.html");
  EXPECT_NE(again, report) << "the second was resumed and says so";
  EXPECT_EQ(without_when(again), without_when(report)) << "and says nothing else that is new";
  EXPECT_EQ(files_below(folder / "out"), files);
  const Json run = Json::parse(read_file(folder / "out/run.json"));
  EXPECT_EQ(run["timings"]["replayed_evaluations"], 12);
}

TEST(GlintRun, GivesTheSameBytesForAnyThreadsAndJobs) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", mixed_study());
  run_ok(folder, "one", {"--threads", "1", "--jobs", "1"});
  const std::vector<std::pair<std::string, std::string>> others = {
      {"2", "2"}, {"7", "1"}, {"7", "7"}};
  for (const auto& [threads, jobs] : others) {
    SCOPED_TRACE("threads " + threads + ", jobs " + jobs);
    run_ok(folder, threads + jobs, {"--threads", threads, "--jobs", jobs});
    expect_same_files(folder / (threads + jobs), folder / "one");
  }
}

TEST(GlintRun, InTwoHalvesEqualsOneGo) {
  const TemporaryFolder folder;
  for (const bool is_mixed : {false, true}) {
    SCOPED_TRACE(is_mixed ? "mixed" : "small");
    const std::string name = is_mixed ? "mixed" : "small";
    write_file(folder / "study.toml", is_mixed ? mixed_study() : small_study());
    run_ok(folder, name + "/whole", {"--set", "budget.evaluations=20"});
    run_ok(folder, name + "/halves", {"--set", "budget.evaluations=10"});
    run_ok(folder, name + "/halves", {"--set", "budget.evaluations=20"});
    expect_same_files(folder / name / "halves", folder / name / "whole");
    // An odd number cuts through a batch of two.
    run_ok(folder, name + "/odd", {"--set", "budget.evaluations=7"});
    run_ok(folder, name + "/odd", {"--set", "budget.evaluations=20"});
    expect_same_files(folder / name / "odd", folder / name / "whole");
  }
}

TEST(GlintRun, SeedChangesTheSearch) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", mixed_study());
  run_ok(folder, "one", {"--set", "search.algorithm=crs2"});
  run_ok(folder, "two", {"--set", "search.algorithm=crs2", "--seed", "2"});
  EXPECT_NE(read_file(folder / "one/trials.csv"), read_file(folder / "two/trials.csv"));
}

TEST(GlintRun, EndsByItsWallClockWithExitZero) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             edited(slow_study(), {{"evaluations = 40", "evaluations = 100000"}}));
  const ProgramResult result = glint_in(folder, run_arguments("out", {"--budget", "0.3s"}));
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(Json::parse(result.out)["status"], "budget");
}

TEST(GlintRun, WithoutAFeasibleDesignExitsWithOne) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", edited(small_study(), {{"{ max = 0.9 }", "{ min = 0.999 }"}}));
  const ProgramResult result = glint_in(folder, run_arguments("out"));
  EXPECT_EQ(result.code, 1);
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["status"], "no_feasible");
  EXPECT_EQ(json["evaluations"], 12);
  EXPECT_TRUE(fs::exists(folder / "out/report.html"));
}

// Tunnels of 2 to 9 mm radius around a part of 12 mm width: the wider ones fit.
TEST(GlintRun, RecordsFailedEvaluationsAndGoesOn) {
  const TemporaryFolder folder;
  write_file(
      folder / "study.toml",
      edited(small_study(),
             {{"slot_mm = 14", "slot_mm = 3"}, {"min = 60, max = 120", "min = 2, max = 9"}}));
  const ProgramResult result = glint_in(folder, run_arguments("out"));
  EXPECT_EQ(result.code, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_GE(json["failed"], 1);
  EXPECT_LT(json["failed"], json["evaluations"]);
  EXPECT_THAT(read_file(folder / "out/trials.csv"),
              ::testing::HasSubstr("the tunnel is smaller than the part"));
}

TEST(GlintRun, WhereEveryEvaluationFailsExitsWithOne) {
  const TemporaryFolder folder;
  write_file(
      folder / "study.toml",
      edited(small_study(),
             {{"slot_mm = 14", "slot_mm = 3"}, {"min = 60, max = 120", "min = 2, max = 5"}}));
  const ProgramResult result = glint_in(folder, run_arguments("out"));
  EXPECT_EQ(result.code, 1) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["status"], "no_feasible");
  EXPECT_TRUE(json["best"].is_null());
  EXPECT_EQ(json["failed"], json["evaluations"]);
}

// From 225 mm on the picture holds the plate's whole top, 2400 of 5200 mm2; from 100 mm a fifth of
// it.
TEST(GlintRun, SearchesForCoverage) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             std::string(kCoveredPlate) +
                 "[objective]\nmaximise = \"coverage.c1\"\n[budget]\nevaluations = 12\n");
  const ProgramResult printed = glint_in(folder, run_arguments("out"));
  ASSERT_EQ(printed.code, 0) << printed.err;
  const Json best = Json::parse(printed.out)["best"];
  EXPECT_NEAR(best["scores"]["coverage.c1"].get<double>(), 2400.0 / 5200.0, 0.01);
  EXPECT_GT(best["variables"]["viewpoints.radius_mm"].get<double>(), 210.0);
}

// Longer exposures are farther from the photograph: the limit ends them.
TEST(GlintRun, KeepsALimitOfLikenessToAPhotograph) {
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", kPhotographedPlate);
  const ProgramResult photo =
      glint_in(folder, {"render", "scene.toml", "--quiet", "--out", "photo"});
  ASSERT_EQ(photo.code, 0) << photo.err;
  fs::copy_file(folder / "photo/baseline/image.tif", folder / "real.tif");
  write_file(folder / "study.toml",
             std::string(kPhotographedPlate) +
                 "[reference]\npictures = [\"real.tif\"]\n"
                 "[variables]\n\"sensor.exposure\" = { min = 0.6, max = 1.8 }\n"
                 "[objective]\nmaximise = \"appearance.rms\"\n"
                 "[constraints]\n\"appearance.histogram_distance\" = { max = 0.1 }\n"
                 "\"overlap.iou\" = { min = 0.9 }\n"
                 "[budget]\nevaluations = 16\n");
  const ProgramResult printed = glint_in(folder, run_arguments("out"));
  ASSERT_EQ(printed.code, 0) << printed.err;
  const Json scores = Json::parse(printed.out)["best"]["scores"];
  EXPECT_LE(scores["appearance.histogram_distance"].get<double>(), 0.1);
  EXPECT_GE(scores["overlap.iou"].get<double>(), 0.9);
  EXPECT_GT(scores["appearance.rms"].get<double>(), 0.01);
}

}  // namespace
}  // namespace glint::test
