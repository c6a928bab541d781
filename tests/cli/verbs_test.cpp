// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every verb but run, on small input.
#include <set>

#include <nlohmann/json.hpp>

#include "core/config/key_writer.h"
#include "metrics/scores.h"
#include "studies/definition/scene.h"
#include "studies/definition/study_tables.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;

using ::testing::HasSubstr;

/// The one JSON object a call prints.
Json json_of(const TemporaryFolder& folder, Arguments arguments) {
  arguments.emplace_back("--json");
  const ProgramResult result = glint_in(folder, arguments);
  EXPECT_EQ(result.code, 0) << result.err;
  return Json::parse(result.out);
}

TEST(Help, OfEveryVerbShowsAnExample) {
  const TemporaryFolder folder;
  for (const std::string verb :
       {"run", "check", "render", "frontier", "report", "part", "explain", "new"}) {
    const ProgramResult help = glint_in(folder, {verb, "--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_EQ(help.err, "");
    EXPECT_THAT(help.out, HasSubstr("Example:\n  glint " + verb + " "));
    for (const std::string option : {"--json", "--quiet", "--threads", "--log"}) {
      EXPECT_THAT(help.out, HasSubstr(option)) << verb;
    }
  }
}

TEST(Help, OfTheProgramNamesTheVerbsAndItsVersion) {
  const TemporaryFolder folder;
  const ProgramResult help = glint_in(folder, {"--help"});
  EXPECT_EQ(help.code, 0);
  for (const std::string verb :
       {"run", "check", "render", "frontier", "report", "part", "explain", "new"}) {
    EXPECT_THAT(help.out, HasSubstr("\n  " + verb + " "));
  }
  const ProgramResult version = glint_in(folder, {"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_THAT(version.out, ::testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+.*\n"));
}

TEST(Explain, KnowsEveryKeyOfTheKeyTable) {
  const TemporaryFolder folder;
  std::vector<KeyRow> rows = scene_keys();
  const std::vector<KeyRow> more = study_keys();
  rows.insert(rows.end(), more.begin(), more.end());
  std::map<std::string, std::set<std::string>> families;
  for (const KeyRow& row : rows) {
    families[row.path.substr(0, row.path.find('.'))].insert(row.path);
    EXPECT_NE(row.doc, "") << row.path;
  }
  EXPECT_EQ(families.size(), 22U);
  for (const auto& [family, paths] : families) {
    std::set<std::string> found;
    const Json json = json_of(folder, {"explain", family});
    for (const Json& row : json["found"]) {
      if (row.contains("key")) {
        found.insert(row["key"]);
      }
    }
    for (const std::string& path : paths) {
      EXPECT_TRUE(found.contains(path)) << path;
    }
  }
}

TEST(Explain, TellsUnitRangeAndDefault) {
  const TemporaryFolder folder;
  const Json found = json_of(folder, {"explain", "lighting.tunnel.radius_mm"})["found"];
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0]["unit"], "mm");
  EXPECT_EQ(found[0]["kind"], "number");
  EXPECT_NE(found[0]["allowed"], "");
  EXPECT_NE(found[0]["default"], "");
  // Named lights, named defects and array elements are explained by what they are made of.
  EXPECT_EQ(json_of(folder, {"explain", "lighting.top.radius_mm"})["found"], found);
  EXPECT_EQ(json_of(folder, {"explain", "viewpoint.0.position_mm.2"})["found"][0]["key"],
            "viewpoint.0.position_mm");
}

TEST(Explain, KnowsScoresAndPartsOfNames) {
  const TemporaryFolder folder;
  const ProgramResult score = glint_in(folder, {"explain", "homogeneity.h_rms"});
  EXPECT_EQ(score.code, 0);
  EXPECT_THAT(score.out, HasSubstr("1 - standard deviation / mean"));
  EXPECT_THAT(score.out, HasSubstr("a score"));
  EXPECT_EQ(json_of(folder, {"explain", "defects.dent_3.cnr"})["found"][0]["score"],
            "defects.dent_3.cnr");
  EXPECT_EQ(json_of(folder, {"explain", "period_mm"})["found"][0]["key"],
            "lighting.tunnel.period_mm");
}

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
  EXPECT_THAT(result.err, HasSubstr("is the file in m?"));
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
  EXPECT_TRUE(json["baseline"]["scores"].contains("homogeneity.h_rms"));
  EXPECT_EQ(json["prototypes"].size(), 2U);
  EXPECT_EQ(folder.count(), 1);
}

// An ellipse has no radius; a semicylinder does.
TEST(Check, NamesVariablesThatChangeNothing) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  EXPECT_TRUE(json_of(folder, {"check", "study.toml"})["idle_variables"].empty());
  const Json json =
      json_of(folder, {"check", "study.toml", "--set", "lighting.tunnel.shape=ellipse"});
  ASSERT_EQ(json["idle_variables"].size(), 1U);
  EXPECT_EQ(json["idle_variables"][0], "lighting.tunnel.radius_mm");
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
