// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint imprint`: files, resuming.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/image/image_io.h"
#include "simulator/geometry/mesh_file/mesh_io.h"
#include "tests/cli/imprint_fixture.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

/// files_below() without the run.json of numbered parts.
std::map<std::string, std::string> timeless_files(const fs::path& folder) {
  auto files = files_below(folder);
  std::erase_if(files,
                [](const auto& file) { return fs::path(file.first).filename() == "run.json"; });
  return files;
}

void expect_same_parts(const fs::path& folder, const fs::path& expected) {
  const auto mine = timeless_files(folder);
  const auto theirs = timeless_files(expected);
  std::vector<std::string> names[2];
  for (const auto& [name, bytes] : mine) {
    names[0].push_back(name);
    const auto other = theirs.find(name);
    EXPECT_TRUE(other == theirs.end() || other->second == bytes) << name << " differs";
  }
  for (const auto& file : theirs) {
    names[1].push_back(file.first);
  }
  EXPECT_EQ(names[0], names[1]);
}

TEST_F(ImprintVerb, WritesOnePartAndPrintsIt) {
  const Json result = imprint_json("out");
  EXPECT_EQ(result["schema"], 1);
  EXPECT_EQ(result["status"], "done");
  EXPECT_EQ(result["seed"], 3);
  EXPECT_GE(result["defects"].size(), 2U);
  EXPECT_LE(result["defects"].size(), 3U);
  EXPECT_EQ(result["made"], result["defects"].size());
  EXPECT_EQ(result["given_up"], 0);
  double removed_mm3 = 0.0;
  for (const Json& defect : result["defects"]) {
    EXPECT_GT(defect["removed_volume_mm3"], 0.0) << defect;
    removed_mm3 += defect["removed_volume_mm3"].get<double>();
  }
  EXPECT_NEAR(result["removed_volume_mm3"].get<double>(), removed_mm3, 1e-12);
  const Json files = {"defect_map.mtl",
                      "defect_map.obj",
                      "defects.json",
                      "part.ply",
                      "part.stl",
                      "preview_defects.png",
                      "preview_image_0.png",
                      "preview_image_1.png",
                      "preview_map_0.png",
                      "preview_map_1.png",
                      "run.json",
                      "scene.resolved.toml"};
  EXPECT_EQ(result["files"], files);
  for (const Json& file : files) {
    EXPECT_TRUE(fs::exists(folder_ / "out" / file.get<std::string>())) << file;
  }
  const Json run = Json::parse(read_file(folder_ / "out/run.json"));
  EXPECT_EQ(run["timings"]["defects"].size(), result["defects"].size());
  EXPECT_EQ(folder_.count(), 2) << "only the scene and the parts";
}

// The volume that is told is the volume the files have lost.
TEST_F(ImprintVerb, TakesAwayTheVolumeItTells) {
  write(edited(kShaft,
               {{"[defects.dent]", "[imprint.processing]\nlevels = 0\n[defects.dent]"},
                {"radius_mm = 8\n", "radius_mm = 8\nfacets_um = 2\n"}}));
  const Json result = imprint_json("out", {"--no_previews"});
  ASSERT_EQ(glint_in(folder_, {"part", "study.toml", "--out", "clean.ply", "--quiet"}).code, 0);
  const double before_mm3 = enclosed_volume_mm3(read_mesh(folder_ / "clean.ply"));
  const double after_mm3 = enclosed_volume_mm3(read_mesh(folder_ / "out/part.ply"));
  EXPECT_NEAR(before_mm3 - after_mm3, result["removed_volume_mm3"].get<double>(), 1e-8);
}

TEST_F(ImprintVerb, GivesTheSameBytesAgain) {
  imprint_json("first");
  imprint_json("second", {"--threads", "3"});
  expect_same_parts(folder_ / "second", folder_ / "first");
  imprint_json("first");
  expect_same_parts(folder_ / "first", folder_ / "second");
}

TEST_F(ImprintVerb, TakesTheSeedOfTheCommandLine) {
  const Json three = imprint_json("three", {"--no_previews"});
  const Json four = imprint_json("four", {"--no_previews", "--seed", "4"});
  EXPECT_EQ(four["seed"], 4);
  EXPECT_NE(three["defects"], four["defects"]);
}

TEST_F(ImprintVerb, DrawsTheGivenViewpointInsteadOfItsOwn) {
  write(std::string(kShaft) +
        "[camera]\nwidth_px = 400\nheight_px = 200\nobject_pixel_mm = 0.1\n"
        "[[viewpoint]]\nposition_mm = [0, 0, 300]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\n");
  const Json result = imprint_json("out");
  EXPECT_THAT(result["files"].dump(), ::testing::Not(HasSubstr("preview_image_1")));
  const ImageF image = read_image(folder_ / "out/preview_image_0.png");
  EXPECT_EQ(image.width(), 1024);
  EXPECT_EQ(image.height(), 512);
}

TEST_F(ImprintVerb, SaysWhatIsNotInTheMesh) {
  write(edited(kShaft, {{"realisation = \"imprinted\"\ncount = 1\n", "count = 1\n"}}));
  const Json result = imprint_json("out", {"--no_previews"});
  ASSERT_EQ(result["notes"].size(), 1U);
  EXPECT_THAT(result["notes"][0].get<std::string>(),
              HasSubstr("1 of the defects are realised by their"));
}

// The shaft is 16 mm thick: half of that is left of 12 mm.
TEST_F(ImprintVerb, SaysWhatTheWallMadeShallower) {
  write(edited(kShaft, {{"height_um = [50, 150]", "height_um = 12000"}}));
  const ProgramResult result =
      glint_in(folder_, {"imprint", "study.toml", "--out", "out", "--no_previews"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("note: "));
  EXPECT_THAT(result.out, HasSubstr("shallower than height_um says"));
  EXPECT_THAT(result.out, HasSubstr(" um deep instead of 12000 um in a wall of 16 mm"));
  const Json metadata = Json::parse(read_file(folder_ / "out/defects.json"));
  EXPECT_THAT(metadata["notes"].dump(), HasSubstr("shallower than height_um says"));
}

TEST_F(ImprintVerb, MakesNoDefectOfAGroupWhoseCountIsZero) {
  const Json without_dents =
      imprint_json("out", {"--no_previews", "--set", "defects.dent.count=0"});
  EXPECT_EQ(without_dents["made"], 1);
  EXPECT_EQ(without_dents["defects"][0]["label"], "scratch_1");
  const Json none = imprint_json(
      "none",
      {"--no_previews", "--set", "defects.dent.count=0", "--set", "defects.scratch.count=0"});
  EXPECT_EQ(none["made"], 0);
  EXPECT_THAT(none["notes"].dump(), HasSubstr("the part has no defect"));
}

// A dent's ball is steepest at its rim: between a third and all of a right angle for 50 to 150 um
// over 1 to 2 mm it is not.
TEST_F(ImprintVerb, TellsHowSteepTheDefectsAre) {
  const Json result = imprint_json("out", {"--no_previews"});
  for (const Json& defect : result["defects"]) {
    EXPECT_GT(defect["max_slope_mrad"], 50.0) << defect;
    EXPECT_LT(defect["max_slope_mrad"], 1571.0) << defect;
  }
}

TEST_F(ImprintVerb, PrintsATableForPeople) {
  const ProgramResult result =
      glint_in(folder_, {"imprint", "study.toml", "--out", "out", "--no_previews"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("scratch_1"));
  EXPECT_THAT(result.out, HasSubstr("imprinted"));
  EXPECT_THAT(result.out, HasSubstr("mm3 removed\nfiles: out\n"));
}

TEST_F(ImprintVerb, MakesTheSamePartsWithAnyNumberOfThreads) {
  const Json one = imprint_json("one", {"--count", "6", "--threads", "1", "--no_previews"});
  const Json four = imprint_json("four", {"--count", "6", "--threads", "4", "--no_previews"});
  EXPECT_EQ(one["status"], "done");
  EXPECT_EQ(one["parts"], four["parts"]);
  EXPECT_EQ(one["parts"].size(), 6U);
  EXPECT_NE(one["parts"][0]["seed"], one["parts"][1]["seed"]);
  expect_same_parts(folder_ / "four", folder_ / "one");
  EXPECT_EQ(timeless_files(folder_ / "one").size(), 6U * 5U + 2U);
  double removed_mm3 = 0.0;
  for (const Json& part : one["parts"]) {
    removed_mm3 += part["removed_volume_mm3"].get<double>();
  }
  EXPECT_NEAR(one["removed_volume_mm3"].get<double>(), removed_mm3, 1e-9);
}

TEST_F(ImprintVerb, GoesOnAfterThePartsThatAreThere) {
  const Arguments few = {"--count", "2", "--no_previews"};
  const Arguments more = {"--count", "5", "--no_previews"};
  imprint_json("whole", more);
  imprint_json("out", few);
  const auto written = fs::last_write_time(folder_ / "out/part_0001/part.stl");
  fs::remove_all(folder_ / "out/part_0000");
  fs::create_directories(folder_ / "out/.part_0000.999999999.part");
  imprint_json("out", more);
  EXPECT_EQ(fs::last_write_time(folder_ / "out/part_0001/part.stl"), written);
  expect_same_parts(folder_ / "out", folder_ / "whole");
  EXPECT_FALSE(fs::exists(folder_ / "out/.part_0000.999999999.part"));
}

std::ptrdiff_t finished_parts(const fs::path& out) {
  std::error_code ignored;
  std::ptrdiff_t count = 0;
  for (fs::directory_iterator at(out, ignored), end; at != end; at.increment(ignored)) {
    count += at->path().filename().string().starts_with("part_") ? 1 : 0;
  }
  return count;
}

/// Waits until that many parts are there; false when the program ends before.
bool wait_for_parts(Program& program, const fs::path& out, std::ptrdiff_t count) {
  while (program.is_running()) {
    if (finished_parts(out) >= count) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

const Arguments kMany = {
    "imprint", "study.toml", "--quiet", "--json", "--out", "out", "--count", "80", "--no_previews"};

TEST_F(ImprintVerb, InterruptedExits130AndGoesOn) {
  ASSERT_EQ(imprint("whole", {"--count", "80", "--no_previews"}).code, 0);
  Program program(folder_.path(), kMany);
  ASSERT_TRUE(wait_for_parts(program, folder_ / "out", 3));
  program.send(SIGINT);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.code, 130);
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["status"], "interrupted");
  EXPECT_GE(json["parts"].size(), 3U);
  EXPECT_LT(json["parts"].size(), 80U);
  EXPECT_FALSE(fs::exists(folder_ / "out/parts.json"));
  EXPECT_EQ(glint_in(folder_, kMany).code, 0);
  expect_same_parts(folder_ / "out", folder_ / "whole");
}

TEST_F(ImprintVerb, KilledLeavesWholePartsAndGoesOn) {
  ASSERT_EQ(imprint("whole", {"--count", "80", "--no_previews"}).code, 0);
  Program program(folder_.path(), kMany);
  ASSERT_TRUE(wait_for_parts(program, folder_ / "out", 5));
  program.send(SIGKILL);
  program.wait();
  EXPECT_EQ(glint_in(folder_, kMany).code, 0);
  expect_same_parts(folder_ / "out", folder_ / "whole");
}

TEST_F(ImprintVerb, LeavesAFolderOfAnotherConfigurationAlone) {
  imprint_json("out", {"--no_previews"});
  const auto before = files_below(folder_ / "out");
  const std::vector<std::pair<Arguments, std::string>> others = {
      {{"--seed", "9"}, " (imprint.seed is 9, was 3)"},
      {{"--count", "2"}, ""},
      {{"--set", "part.radius_mm=7"}, " (part.radius_mm is 7, was 8)"}};
  for (const auto& [other, difference] : others) {
    const ProgramResult result = imprint("out", other);
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.err,
              "out: holds parts of another configuration" + difference +
                  "; choose another output folder, or remove this one\n");
  }
  EXPECT_EQ(files_below(folder_ / "out"), before);
}

// The scene's folder may hold the user's own part.stl.
TEST_F(ImprintVerb, OverwritesNoFileThatIsNotItsOwn) {
  write_file(folder_ / "part.stl", "mine");
  const ProgramResult result = imprint(".", {"--no_previews"});
  EXPECT_EQ(result.code, 2);
  EXPECT_EQ(result.err,
            ".: holds a part.stl that is not of `glint imprint`; choose another output folder\n");
  EXPECT_EQ(read_file(folder_ / "part.stl"), "mine");
  EXPECT_EQ(folder_.count(), 2) << "the scene and the user's file";
}

// What the metadata says does not depend on where the scene lies.
TEST_F(ImprintVerb, NamesToolFoldersAsTheSceneDoes) {
  const std::string scene = edited(kShaft, {{"tool_level = 2", "tool_folder = \"tools\""}});
  std::string metadata[2];
  for (int i = 0; i < 2; ++i) {
    const fs::path at = folder_ / (i == 0 ? "here" : "far/away");
    fs::create_directories(at / "tools");
    write_file(at / "tools/spike.off", kTetrahedron);
    write_file(at / "study.toml", scene);
    const ProgramResult result =
        glint_in(at, {"imprint", "study.toml", "--quiet", "--no_previews", "--out", "out"});
    ASSERT_EQ(result.code, 0) << result.err;
    metadata[i] = read_file(at / "out/defects.json");
  }
  EXPECT_EQ(metadata[0], metadata[1]);
  EXPECT_EQ(Json::parse(metadata[0])["groups"]["dent"]["tool_folder"], "tools");
}

TEST_F(ImprintVerb, DrawsItsTools) {
  const Json result = imprint_json("tools_of_shaft", {"--preview_tools"});
  EXPECT_EQ(result["status"], "done");
  ASSERT_EQ(result["tools"].size(), 12U) << "six of each group";
  for (const Json& tool : result["tools"]) {
    const TriangleMesh mesh =
        read_mesh(folder_ / "tools_of_shaft" / tool["file"].get<std::string>());
    EXPECT_EQ(mesh.num_triangles(), tool["triangles"]);
    EXPECT_GT(tool["volume_mm3"], 0.0);
  }
  const ImageF sheet = read_image(folder_ / "tools_of_shaft/tools.png");
  EXPECT_EQ(sheet.width(), 6 * 198 + 6);
  EXPECT_EQ(sheet.height(), 2 * 198 + 6);
}

TEST_F(ImprintVerb, TakesToolsOfAFolder) {
  fs::create_directories(folder_ / "tools");
  write_file(folder_ / "tools/spike.off", kTetrahedron);
  write(edited(kShaft, {{"tool_level = 2", "tool_folder = \"tools\""}}));
  const Json result = imprint_json("out", {"--no_previews"});
  EXPECT_THAT(result["defects"][0]["tool"].get<std::string>(), HasSubstr("spike"));
  // The tool's bytes are part of the configuration.
  write_file(folder_ / "tools/spike.off", std::string(kTetrahedron) + "\n");
  EXPECT_EQ(imprint("out").code, 2);
}

}  // namespace
}  // namespace glint::test
