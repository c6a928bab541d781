// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint render` of path-traced scenes.
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/support/exr_reader.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;
using ::testing::HasSubstr;

/// A brushed plate with a scratch under a ring of four segments.
constexpr const char* kRingScene = R"(schema = 1
title = "Plate under a ring"
[part]
shape = "plate"
length_mm = 16
width_mm = 12
[material]
type = "conductor"
roughness = 0.25
anisotropy = 0.5
[camera]
width_px = 64
height_px = 48
object_pixel_mm = 0.3
working_distance_mm = 120
[sensor]
wavelengths_nm = [610, 550, 465]
[render.paths]
samples = 8
[lighting.ring]
type = "ring"
mount = "camera"
segments = 4
separate_segments = true
[defects.scratch]
length_mm = 5
width_mm = 0.9
height_um = 40
)";

TEST(RenderVerb, OfAreaLightsWritesLayersOfTheLights) {
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", kRingScene);
  const ProgramResult result =
      glint_in(folder, {"render", "scene.toml", "--out", "r", "--json", "--quiet"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const Json printed = Json::parse(result.out);
  EXPECT_EQ(printed["schema"], 1);
  EXPECT_EQ(printed["status"], "done");
  EXPECT_EQ(printed["report"], "r/report.html");
  EXPECT_EQ(printed["views"][0]["folder"], "r/baseline");
  EXPECT_GE(printed["views"][0]["cpu_s"], 0.0);
  EXPECT_TRUE(printed["scores"].contains("defects.min_cnr.error"));
  const auto image = channels_of(folder / "r/baseline/image.exr");
  EXPECT_EQ(image.size(), 15U) << "the picture and four segments in three colours";
  for (const char* name : {"R", "G", "B", "ring.0.R", "ring.3.B"}) {
    EXPECT_TRUE(image.contains(name)) << name;
  }
  EXPECT_EQ(channels_of(folder / "r/baseline/image.png").size(), 3U);
  for (const auto& [name, sums] : channels_of(folder / "r/baseline/coverage.exr")) {
    for (const float share : sums.values()) {
      EXPECT_TRUE(share >= 0.0F && share <= 1.0F) << name;
    }
  }
}

TEST(RenderVerb, OfMasksTracesNoLight) {
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", kRingScene);
  const ProgramResult result =
      glint_in(folder, {"render", "scene.toml", "--out", "r", "--masks", "--json", "--quiet"});
  ASSERT_EQ(result.code, 0) << result.err;
  const Json printed = Json::parse(result.out);
  EXPECT_EQ(printed["views"][0]["rays"]["shadow"], 0);
  EXPECT_EQ(printed["views"][0]["rays"]["bounce"], 0);
  EXPECT_EQ(printed["views"][0]["rays"]["camera"], 64 * 48 * 8);
  EXPECT_TRUE(fs::exists(folder / "r/baseline/mask.png"));
  EXPECT_FALSE(fs::exists(folder / "r/baseline/image.exr"));
}

TEST(RenderVerb, MasksASceneUnderATunnelToo) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  const ProgramResult result =
      glint_in(folder, {"render", "study.toml", "--out", "r", "--masks", "--json", "--quiet"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(Json::parse(result.out)["views"][0]["rays"]["shadow"], 0);
  EXPECT_TRUE(fs::exists(folder / "r/baseline/coverage.exr"));
}

TEST(RenderVerb, TellsPlaceAndKeyOfAWrongScene) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", edited(kRingScene, {{"roughness = 0.25", "roughness = 7"}}));
  const ProgramResult result = glint_in(folder, {"render", "study.toml", "--out", "r"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("study.toml:9:1: material.roughness: "));
  EXPECT_FALSE(fs::exists(folder / "r"));
}

TEST(RenderVerb, NamesTheLightFileThatIsMissing) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             std::string(kRingScene) + "[lighting.lamp]\ntype = \"ies\"\nfile = \"none.ies\"\n");
  const ProgramResult result = glint_in(folder, {"render", "study.toml", "--out", "r"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("lighting.lamp.file: the file "));
  EXPECT_FALSE(fs::exists(folder / "r"));
}

TEST(RenderVerb, ExplainsMasksInItsHelp) {
  const TemporaryFolder folder;
  const ProgramResult help = glint_in(folder, {"render", "--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.out, HasSubstr("--masks"));
  EXPECT_THAT(help.out, HasSubstr("without sampling any light"));
}

TEST(RenderVerb, LeavesViewsToTheirOwnPage) {
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", kRingScene);
  ASSERT_EQ(glint_in(folder, {"render", "scene.toml", "--out", "r", "--quiet"}).code, 0);
  const ProgramResult result = glint_in(folder, {"report", "r"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("holds rendered views"));
}

}  // namespace
}  // namespace glint::test
