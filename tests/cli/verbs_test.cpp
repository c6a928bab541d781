// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every verb but run, explain and help, on small input.
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Part, ReportsAndConvertsAMesh) {
  const TemporaryFolder folder;
  write_file(folder / "plate.stl", rectangle_stl(4, 1.2));
  const Json json = json_of(folder, {"part", "plate.stl", "--unit", "cm", "--out", "plate.ply"});
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["status"], "done");
  EXPECT_EQ(json["name"], "plate.stl");
  EXPECT_EQ(json["size_mm"], Json({40.0, 12.0, 0.0}));
  EXPECT_EQ(json["area_mm2"], 480.0);
  EXPECT_EQ(json["triangles"], 2);
  EXPECT_EQ(json["vertices"], 4);
  EXPECT_EQ(json["watertight"], false);
  EXPECT_EQ(json["open_edges"], 4);
  EXPECT_TRUE(json["pose"].contains("position_mm"));
  EXPECT_FALSE(json["warnings"].empty());
  const Json again = json_of(folder, {"part", "plate.ply"});
  EXPECT_EQ(again["size_mm"], json["size_mm"]) << "what is written is in mm";
}

TEST(Part, ReadsThePartOfAStudy) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  const Json json = json_of(folder, {"part", "study.toml"});
  EXPECT_EQ(json["exact_surface"], true);
  EXPECT_EQ(json["size_mm"][0], 40.0);
}

TEST(Part, WithoutAUnitThatFitsAsksForIt) {
  const TemporaryFolder folder;
  write_file(folder / "plate.stl", rectangle_stl(0.2, 0.04));
  const ProgramResult result = glint_in(folder, {"part", "plate.stl", "--json"});
  EXPECT_EQ(result.code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err,
              ::testing::MatchesRegex("--unit: plate\\.stl is 0\\.2 mm large: is the file "
                                      "in m\\? The unit \"m\" makes it 200 mm.*"));
}

TEST(Part, ThatIsNotThereIsAFileThatCannotBeRead) {
  const TemporaryFolder folder;
  const ProgramResult result = glint_in(folder, {"part", "gone.stl"});
  EXPECT_EQ(result.code, 3);
  EXPECT_EQ(result.err, "gone.stl: cannot be read: No such file or directory\n");
}

TEST(Check, PredictsWithoutWriting) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", mixed_study());
  const Json json = json_of(folder, {"check", "study.toml"});
  EXPECT_EQ(json["status"], "done");
  EXPECT_EQ(json["variables"], 4);
  EXPECT_EQ(json["evaluations"], 12);
  EXPECT_GT(json["seconds_per_evaluation"], 0.0);
  EXPECT_GT(json["predicted_s"], 0.0);
  const Json& cpu_s = json["predicted_cpu_s"];
  EXPECT_NEAR(
      cpu_s["search"].get<double>(), 12.0 * json["seconds_per_evaluation"].get<double>(), 1e-9);
  EXPECT_GT(cpu_s["rescoring"], 0.0);
  EXPECT_GT(cpu_s["writing"], 0.0);
  EXPECT_EQ(cpu_s["populations"], 0.0);
  EXPECT_TRUE(json["broken_limits"].empty());
  EXPECT_TRUE(json["baseline"]["scores"].contains("homogeneity.h_rms"));
  EXPECT_EQ(json["prototypes"].size(), 2U);
  EXPECT_EQ(folder.count(), 1);
}

TEST(Check, PredictsASearchThatTimeEndsAndNoneThatOnlyAStallEnds) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  const std::vector<std::string> unlimited = {
      "check", "study.toml", "--set", "budget.evaluations=0"};
  const auto with = [&](const std::string& set) {
    std::vector<std::string> arguments = unlimited;
    arguments.insert(arguments.end(), {"--set", set});
    return arguments;
  };
  const Json timed = json_of(folder, with("budget.wall_clock=8h"));
  const double each_s = timed["seconds_per_evaluation"].get<double>();
  EXPECT_GE(timed["predicted_s"].get<double>(), 8 * 3600.0);
  EXPECT_GE(timed["predicted_cpu_s"]["search"].get<double>(), 8 * 3600.0);
  EXPECT_NEAR(timed["evaluations"].get<double>() * each_s,
              timed["predicted_cpu_s"]["search"].get<double>(),
              each_s);
  const Json stalled = json_of(folder, with("budget.stall=50"));
  EXPECT_TRUE(stalled["evaluations"].is_null());
  EXPECT_TRUE(stalled["predicted_s"].is_null());
  EXPECT_TRUE(stalled["predicted_cpu_s"]["search"].is_null());
  EXPECT_GT(stalled["predicted_cpu_s"]["writing"], 0.0);
  EXPECT_THAT(glint_in(folder, with("budget.stall=50")).out,
              AllOf(HasSubstr("cannot be predicted"), HasSubstr("beside the search: re-scoring ")));
}

TEST(Check, SaysWhereMoreEvaluationsFitIntoTheTime) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  const auto with = [](const std::string& threads) {
    return std::vector<std::string>{"check",
                                    "study.toml",
                                    "--set",
                                    "budget.evaluations=0",
                                    "--set",
                                    "budget.wall_clock=8h",
                                    "--jobs",
                                    "1",
                                    "--threads",
                                    threads};
  };
  EXPECT_FALSE(json_of(folder, with("1"))["is_lower_bound"].get<bool>());
  EXPECT_TRUE(json_of(folder, with("2"))["is_lower_bound"].get<bool>());
  EXPECT_THAT(glint_in(folder, with("2")).out, HasSubstr("evaluations or more: threads"));
}

// An ellipse has no radius; a semicylinder does.
TEST(Check, NamesVariablesThatChangeNothing) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  EXPECT_TRUE(json_of(folder, {"check", "study.toml"})["insensitive_variables"].empty());
  const Json json =
      json_of(folder, {"check", "study.toml", "--set", "lighting.tunnel.shape=ellipse"});
  ASSERT_EQ(json["insensitive_variables"].size(), 1U);
  EXPECT_EQ(json["insensitive_variables"][0], "lighting.tunnel.radius_mm");
  EXPECT_EQ(json["idle_variables"], json["insensitive_variables"]) << "the name of before";
  EXPECT_THAT(
      glint_in(folder, {"check", "study.toml", "--set", "lighting.tunnel.shape=ellipse"}).out,
      HasSubstr(": the study can be run, 1 warning, 2 variables"));
}

// The ring's outer radius is 60 mm, which its inner one reaches at the end of its range.
TEST(Check, NamesTheLimitThatBreaksARule) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             edited(small_study(),
                    {{"[lighting.tunnel]",
                      "[lighting.ring]\nheight_mm = 80\ninner_radius_mm = 40\nouter_radius_mm = "
                      "60\n[lighting.tunnel]"},
                     {"[variables]",
                      "[variables]\n\"lighting.ring.inner_radius_mm\" = { min = 20, max = 60 }"}}));
  const Json json = json_of(folder, {"check", "study.toml", "--set", "render.paths.samples=4"});
  ASSERT_EQ(json["broken_limits"].size(), 1U);
  EXPECT_THAT(
      json["broken_limits"][0].get<std::string>(),
      ::testing::MatchesRegex("study\\.toml:[0-9]+:[0-9]+: lighting\\.ring\\.inner_radius_mm "
                              "= 60, the max of its variable, gives a design that fails: "
                              "lighting\\.ring\\.outer_radius_mm is 60, must be .*"));
}

TEST(Check, RefusesACameraInsideThePart) {
  const TemporaryFolder folder;
  write_file(folder / "cube.off",
             "OFF\n8 6 0\n0 0 0\n20 0 0\n20 20 0\n0 20 0\n0 0 20\n20 0 20\n20 20 20\n0 20 20\n"
             "4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
  write_file(folder / "scene.toml",
             "[part]\nfile = \"cube.off\"\n[camera]\nwidth_px = 40\nheight_px = 40\n"
             "object_pixel_mm = 0.1\nworking_distance_mm = 2\n[lighting.tunnel]\nradius_mm = 90\n");
  for (const std::string verb : {"check", "run"}) {
    const ProgramResult inside = glint_in(folder, {verb, "scene.toml"});
    EXPECT_EQ(inside.code, 2);
    EXPECT_THAT(
        inside.err,
        HasSubstr("scene.toml:7:1: camera.working_distance_mm: puts the camera at (0, 0, 2) "
                  "mm, inside the part"));
    EXPECT_EQ(inside.out, "");
    EXPECT_EQ(folder.count(), 2);
  }
}

TEST(Render, TellsScoresWithUnitAndMeaning) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", mixed_study());
  const ProgramResult result = glint_in(folder, {"render", "study.toml", "--out", "pictures"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(
      result.out,
      ::testing::ContainsRegex("  homogeneity\\.h_rms +-?[0-9.]+ %  1 - standard deviation"));
  EXPECT_THAT(result.out,
              ::testing::ContainsRegex("  fringe\\.period_px +[0-9.]+ px  mean stripe"));
  EXPECT_THAT(result.out, ::testing::ContainsRegex("\n  defect +cnr +dprime +weber"));
  EXPECT_THAT(result.out, Not(HasSubstr("defects.dent_1.cnr  ")));
}

TEST(Render, WritesPicturesOfTheStudysOwnScene) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", mixed_study());
  const Json json = json_of(folder, {"render", "study.toml", "--out", "pictures"});
  EXPECT_EQ(json["status"], "done");
  EXPECT_TRUE(json["scores"].contains("homogeneity.h_rms"));
  EXPECT_EQ(json["report"], "pictures/report.html");
  for (const std::string name : {"baseline/sequence/frame_007.png",
                                 "baseline/aspect.exr",
                                 "baseline/part_mask.png",
                                 "baseline/defects.json",
                                 "study.resolved.toml",
                                 "report.html",
                                 "result.json",
                                 "run.json"}) {
    EXPECT_TRUE(fs::exists(folder / "pictures" / name)) << name;
  }
  EXPECT_FALSE(fs::exists(folder / "pictures/study.sqlite"));

  // A shorter scan into the same folder leaves no frame of the longer one.
  json_of(folder, {"render", "study.toml", "--out", "pictures", "--set", "scan.positions=4"});
  json_of(folder, {"render", "study.toml", "--out", "fresh", "--set", "scan.positions=4"});
  expect_same_files(folder / "pictures", folder / "fresh");
}

TEST(Report, OfOneRunAndOfTwo) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  json_of(folder, {"run", "study.toml", "--out", "a", "--quiet"});
  json_of(folder, {"run", "study.toml", "--out", "b", "--quiet", "--set", "scan.positions=12"});
  const std::string written = read_file(folder / "a/report.html");
  fs::remove(folder / "a/report.html");
  EXPECT_EQ(json_of(folder, {"report", "a"})["report"], "a/report.html");
  EXPECT_EQ(read_file(folder / "a/report.html"), written);
  const Json both = json_of(folder, {"report", "a", "b", "--out", "both.html"});
  EXPECT_EQ(both["report"], "both.html");
  EXPECT_GT(fs::file_size(folder / "both.html"), written.size());
}

TEST(Report, OfARunMovedElsewhere) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "parts");
  write_file(folder / "parts/plate.stl", rectangle_stl(40, 12));
  write_file(folder / "study.toml",
             edited(small_study(),
                    {{"shape = \"strip\"", "shape = \"mesh\"\nfile = \"parts/plate.stl\""},
                     {"min = 0.1", "min = 0"}}));
  json_of(folder, {"run", "study.toml", "--out", "deep/er/run", "--quiet"});
  fs::rename(folder / "deep/er/run", folder / "moved");
  json_of(folder, {"report", "moved"});
}

TEST(New, WritesAStudyThatChecks) {
  const TemporaryFolder folder;
  write_file(folder / "plate.stl", rectangle_stl(60, 20));
  fs::create_directory(folder / "studies");
  const Json written = json_of(folder,
                               {"new",
                                "plate.stl",
                                "--camera",
                                "width_px=640,height_px=240,pixel_um=5.5,focal_mm=16",
                                "--working_distance_mm",
                                "300",
                                "--out",
                                "studies/plate.toml"});
  EXPECT_EQ(written["study"], "studies/plate.toml");
  const Json checked = json_of(folder, {"check", "studies/plate.toml"});
  EXPECT_EQ(checked["status"], "done");
  EXPECT_EQ(checked["name"], "plate");
}

TEST(LogOption, AlsoWritesTheLogThere) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  json_of(folder, {"check", "study.toml", "--log", "check.log"});
  EXPECT_TRUE(fs::exists(folder / "check.log"));
  json_of(folder, {"run", "study.toml", "--out", "o", "--log", "run.log"});
  EXPECT_THAT(read_file(folder / "run.log"), HasSubstr("writing winner"));
  EXPECT_THAT(read_file(folder / "o" / "log.txt"), HasSubstr("writing winner"));
  const ProgramResult below =
      glint_in(folder, {"check", "study.toml", "--log", "study.toml/x.log"});
  EXPECT_EQ(below.code, 3);
  EXPECT_THAT(below.err, HasSubstr("study.toml/x.log"));
}

}  // namespace
}  // namespace glint::test
