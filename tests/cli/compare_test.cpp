// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint compare`: pictures drawn here, and views that the program rendered.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/dented_plate.h"
#include "tests/cli/program.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint::test {
namespace {

using Json = nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

class CompareVerb : public ::testing::Test {
 protected:
  void draw(const std::string& name, const BladeDrawing& drawing) const {
    const std::filesystem::path path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    write_png(path, drawn_blade(drawing), PixelDepth::k16Bit);
  }

  TemporaryFolder folder_;
};

TEST_F(CompareVerb, PrintsWhatItFoundAndWritesAPage) {
  draw("simulated.png", {});
  draw("real.png", {.shift_x_px = 0.5, .gain = 1.2, .index = 1});
  const Json result = json_of(folder_, {"compare", "simulated.png", "real.png", "--out", "out"});
  EXPECT_EQ(result["status"], "done");
  ASSERT_EQ(result["pairs"].size(), 1U);
  const Json& pair = result["pairs"][0];
  EXPECT_EQ(pair["simulated"], "simulated");
  EXPECT_EQ(pair["real"], "real");
  EXPECT_GT(pair["iou"].get<double>(), 0.98);
  EXPECT_NEAR(pair["mean_distance_px"].get<double>(), 0.5 * 0.6, 0.15);
  EXPECT_NEAR(pair["exposure"]["gain"].get<double>(), 1.2, 0.02);
  EXPECT_TRUE(result["yardstick"].is_null());
  for (const char* key : {"hd95_px", "offset_px", "ssim", "histogram_distance"}) {
    EXPECT_TRUE(pair.contains(key) && pair[key].is_number()) << key;
  }
  EXPECT_THAT(result["verdict"].get<std::string>(), HasSubstr("silhouettes overlap"));
  // The gain is a cause that pictures alone can tell.
  ASSERT_EQ(pair["causes"].size(), 1U);
  EXPECT_EQ(pair["causes"][0]["name"], "gain");
  EXPECT_GT(pair["causes"][0]["share"].get<double>(), 0.5);
  EXPECT_LE(pair["causes"][0]["share"].get<double>(), 1.0);
  EXPECT_THAT(read_file(folder_ / "out/report.html"),
              AllOf(HasSubstr("Photograph minus simulated"),
                    HasSubstr("mean distance px"),
                    HasSubstr("histogram distance in shares of full scale"),
                    HasSubstr("Texture of the surface"),
                    HasSubstr("Spectrum by direction"),
                    HasSubstr("only light")));
  for (const char* name : {"result.json",
                           "run.json",
                           "pair_01/overlay.png",
                           "pair_01/simulated.png",
                           "pair_01/difference.exr"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / name)) << name;
  }
}

// 1 % larger: 10 px further out at a radius of 1000 px.
TEST_F(CompareVerb, PrintsTheSlopeOfAScale) {
  draw("simulated.png", {});
  draw("real.png", {.scale = 1.01, .index = 1});
  const Json result = json_of(folder_, {"compare", "simulated.png", "real.png", "--out", "out"});
  const Json& slope = result["pairs"][0]["ring_slope"];
  ASSERT_TRUE(slope.is_object()) << slope;
  EXPECT_NEAR(slope["value"].get<double>(), 10.0, 1.0);
  EXPECT_LT(slope["low"].get<double>(), slope["value"].get<double>());
  EXPECT_GT(slope["high"].get<double>(), slope["value"].get<double>());
  EXPECT_GT(result["pairs"][0]["offset_px"].get<double>(), 0.2);
}

// Radiance of any scale as the photograph: exposures are matched.
TEST_F(CompareVerb, TakesAPhotographOfFloats) {
  draw("simulated.png", {});
  ImageF radiance = drawn_blade({.index = 1});
  for (float& value : radiance.values()) {
    value = std::max(20.0F * value, 0.0F);
  }
  write_exr(folder_ / "real.exr", radiance);
  const Json result = json_of(folder_, {"compare", "simulated.png", "real.exr", "--out", "out"});
  EXPECT_GT(result["pairs"][0]["iou"].get<double>(), 0.998);
  EXPECT_THAT(result["pairs"][0]["notes"].dump(), HasSubstr("floats"));
}

TEST_F(CompareVerb, MeasuresAgainstPhotographsAmongEachOther) {
  draw("simulated.png", {});
  draw("photos/1.png", {.noise = 0.01, .index = 1});
  draw("photos/2.png", {.noise = 0.012, .index = 2});
  draw("photos/3.png", {.noise = 0.014, .index = 3});
  const Json result = json_of(folder_, {"compare", "simulated.png", "photos", "--out", "out"});
  EXPECT_EQ(result["pairs"].size(), 3U);
  EXPECT_EQ(result["yardstick"]["reals"], 3);
  EXPECT_THAT(result["verdict"].get<std::string>(),
              HasSubstr("times as much as they differ from each other"));
}

TEST_F(CompareVerb, SaysWhyItRefinesNothing) {
  draw("simulated.png", {});
  draw("real.png", {.gain = 1.2, .index = 1});
  const Json result =
      json_of(folder_, {"compare", "simulated.png", "real.png", "--refine", "--out", "out"});
  EXPECT_THAT(result["notes"].dump(), HasSubstr("no simulated picture comes with the scene"));
}

// Two views with a photograph each: these are not of one kind, and a note says what would be.
TEST_F(CompareVerb, SaysWhyThereIsNoYardstickOfSeveralViews) {
  draw("views/1.png", {});
  draw("views/2.png", {.scale = 0.9});
  draw("photos/1.png", {.index = 1});
  draw("photos/2.png", {.scale = 0.9, .index = 2});
  const Json result = json_of(folder_, {"compare", "views", "photos", "--out", "out"});
  EXPECT_TRUE(result["yardstick"].is_null());
  EXPECT_THAT(result["notes"].dump(),
              HasSubstr("compare one simulated picture with all photographs of a kind"));
}

TEST_F(CompareVerb, RefusesWithOneLineAndNoFolder) {
  draw("simulated.png", {});
  write_png(folder_ / "small.png", ImageF(20, 10, 0.5F), PixelDepth::k8Bit);
  const auto refused = [&](const Arguments& arguments, const std::string& message) {
    const ProgramResult result = glint_in(folder_, arguments);
    EXPECT_EQ(result.code, 2) << result.err;
    EXPECT_THAT(result.err, MatchesRegex(message + "\n"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  };
  refused({"compare", "simulated.png", "--quiet", "--out", "out"},
          "compare needs a simulated picture and at least one real one");
  refused({"compare", "simulated.png", "small.png", "--quiet", "--out", "out"},
          "small\\.png: has one grey value all over, .*");
  const auto refused_picture =
      [&](const std::string& name, const ImageF& picture, const std::string& message) {
        write_png(folder_ / name, picture, PixelDepth::k8Bit);
        refused({"compare", "simulated.png", name, "--quiet", "--out", "out"}, message);
      };
  refused_picture("black.png", ImageF(200, 160), "black\\.png: is black all over, .*");
  refused_picture(
      "white.png", ImageF(200, 160, 1.0F), "white\\.png: is at full scale all over, .*");
  ImageF other(20, 10, 0.5F);
  other(3, 3) = 0.9F;
  refused_picture("other.png",
                  other,
                  "simulated\\.png: is 200 x 160 pixels, other\\.png is 20 x 10: .* one size");
  for (const char* name :
       {"views/a.png", "views/b.png", "photos/x.png", "photos/y.png", "photos/z.png"}) {
    draw(name, {});
  }
  refused({"compare", "views", "photos", "--quiet", "--out", "out"},
          "views/a\\.png: has no real picture: 2 simulated and 3 real pictures .*");
  refused(
      {"compare", "simulated.png", "simulated.png", "--outline", "line", "--quiet", "--out", "out"},
      "--outline: is line, must be auto, threshold, grab_cut or inner");
}

/// Whether a cause, or one that it cannot be told from, has that name.
bool is_told(const Json& causes, const std::string& name) {
  return std::ranges::any_of(causes, [&](const Json& cause) {
    const Json group = cause.value("group", Json::array());
    return cause["name"] == name || std::ranges::count(group, Json(name)) > 0;
  });
}

using CoverVerb = CompareVerb;

// The plate's front is seen, 16 x 12 of its whole surface.
TEST_F(CoverVerb, PrintsWhatTheViewsInspect) {
  const std::string plate = kDentedPlate;
  write_file(folder_ / "scene.toml",
             plate.substr(0, plate.find("[defects.dent]")) +
                 "[coverage]\npoints = 1000\nhas_light = false\n");
  const Json result = json_of(folder_, {"cover", "scene.toml", "--out", "out"});
  EXPECT_EQ(result["status"], "done");
  EXPECT_GT(result["c1"].get<double>(), 0.3);
  EXPECT_LT(result["c1"].get<double>(), 0.5);
  ASSERT_FALSE(result["ck"].empty());
  EXPECT_EQ(result["ck"][0], result["c1"]);
  ASSERT_EQ(result["views"].size(), 1U);
  EXPECT_EQ(result["views"][0]["name"], "view_01");
  EXPECT_NEAR(result["views"][0]["adds"].get<double>(), result["c1"].get<double>(), 1e-12);
  EXPECT_GT(result["largest_gap_mm2"].get<double>(), 100.0);
}

/// A run of two evaluations and a photograph of its winner, made once; each test has a copy.
class ComparedDesign : public CompareVerb {
 protected:
  static void SetUpTestSuite() {
    made_ = std::make_unique<TemporaryFolder>();
    write_file(*made_ / "study.toml",
               kDentedPlate +
                   "[variables]\n\"lighting.ring.height_mm\" = { min = 40, max = 90 }\n"
                   "[objective]\nmaximise = \"defects.min_cnr\"\n[budget]\nevaluations = 2\n");
    call({"run", "study.toml", "--quiet", "--out", "run"});
    call({"render",
          "run/winner/scene.toml",
          "--set",
          "camera.center_x_px=62",
          "--set",
          "sensor.seed=9",
          "--quiet",
          "--out",
          "photo"});
  }

  static void TearDownTestSuite() { made_.reset(); }

  void SetUp() override {
    std::filesystem::copy(made_->path(), folder_.path(), std::filesystem::copy_options::recursive);
  }

  static void call(const Arguments& arguments) {
    const ProgramResult result = glint_in(*made_, arguments);
    ASSERT_EQ(result.code, 0) << result.err;
  }

  Json compared() const {
    return json_of(folder_, {"compare", "run/winner", "photo/baseline/image.tif", "--out", "out"});
  }

 private:
  inline static std::unique_ptr<TemporaryFolder> made_;
};

// A run leaves no geometry.exr: it is rendered. The camera's centre lies 2 px to the right.
TEST_F(ComparedDesign, HasNamedEdgesAndCauses) {
  ASSERT_FALSE(std::filesystem::exists(folder_ / "run/winner/geometry.exr"));
  const Json result = compared();
  const Json& pair = result["pairs"][0];
  ASSERT_FALSE(pair["edges"].empty());
  for (const Json& edge : pair["edges"]) {
    EXPECT_TRUE(edge.contains("surface")) << edge;
  }
  EXPECT_EQ(pair["edges"][0].value("beyond", ""), "background") << pair["edges"];
  EXPECT_TRUE(is_told(pair["causes"], "centre_x")) << pair["causes"] << pair["notes"];
  const Json& timings = result["timings"];
  EXPECT_GT(timings["render_s"].get<double>(), 0.0);
  EXPECT_NEAR(timings["this_run_s"].get<double>(),
              timings["render_s"].get<double>() + timings["compare_s"].get<double>(),
              1e-9);
  const Json run = Json::parse(read_file(folder_ / "out/run.json"));
  EXPECT_GT(run["timings"]["render_s"].get<double>(), 0.0);
}

// What is not written again would be of other pictures; a person's file stays, with its folder.
TEST_F(ComparedDesign, LeavesNothingOfAnEarlierComparison) {
  const std::string real = "photo/baseline/image.tif";
  const auto has = [&](const char* name) {
    return std::filesystem::exists(folder_ / "out" / name);
  };
  json_of(folder_, {"compare", "run/winner", real, "--refine", "--out", "out"});
  ASSERT_TRUE(has("pair_01/refined.toml"));
  json_of(folder_, {"compare", "run/winner", real, real, real, "--out", "out"});
  EXPECT_FALSE(has("pair_01/refined.toml"));
  ASSERT_TRUE(has("pair_02/overlay.png"));
  ASSERT_TRUE(has("pair_03/difference.exr"));
  write_file(folder_ / "out/pair_03/mine.txt", "notes");
  const ProgramResult refused = glint_in(
      folder_, {"compare", "run/winner", "out/pair_03/simulated.png", "--quiet", "--out", "out"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("lies where results are written: copy it"));
  json_of(folder_, {"compare", "run/winner", real, "--out", "out"});
  EXPECT_TRUE(has("pair_01/overlay.png"));
  EXPECT_FALSE(has("pair_02"));
  EXPECT_FALSE(has("pair_03/overlay.png"));
  EXPECT_FALSE(has("pair_03/difference.exr"));
  EXPECT_TRUE(has("pair_03/mine.txt"));
}

TEST_F(ComparedDesign, TakesAPersonsPictureFromTheFolderOfAPair) {
  const std::string real = "photo/baseline/image.tif";
  const Json first = json_of(folder_, {"compare", "run/winner", real, real, "--out", "out"});
  const std::vector<std::string> own = {"out/pair_01/mine.tif", "out/pair_02/mine.tif"};
  for (const std::string& mine : own) {
    std::filesystem::copy_file(folder_ / real, folder_ / mine);
  }
  for (const std::string& mine : own) {
    const Json again = json_of(folder_, {"compare", "run/winner", mine, "--out", "out"});
    EXPECT_EQ(again["pairs"][0]["iou"], first["pairs"][0]["iou"]);
    EXPECT_EQ(read_file(folder_ / mine), read_file(folder_ / real));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/pair_02/overlay.png"));
  for (const char* written : {"out/pair_01/overlay.png", "out/pair_01/../pair_01/simulated.png"}) {
    const ProgramResult refused =
        glint_in(folder_, {"compare", "run/winner", written, "--quiet", "--out", "out"});
    EXPECT_EQ(refused.code, 2) << written;
    EXPECT_THAT(refused.err, HasSubstr("choose another output folder than out")) << written;
    EXPECT_TRUE(std::filesystem::exists(folder_ / written));
  }
}

TEST_F(ComparedDesign, SaysWhyItHasNoGeometry) {
  const auto scene = folder_ / "run/winner/scene.toml";
  write_file(scene, edited(read_file(scene), {{"width_px = 120", "width_px = 124"}}));
  const Json result = compared();
  EXPECT_THAT(result["pairs"][0]["notes"].dump(),
              AllOf(HasSubstr("run/winner has no geometry.exr"), HasSubstr("124 x 90 pixels")));
  EXPECT_FALSE(is_told(result["pairs"][0]["causes"], "centre_x"));
}

// The picture alone says nothing of the part: with the scene that it was rendered from it does.
TEST_F(ComparedDesign, TakesTheSceneOfAPictureByItself) {
  std::filesystem::copy_file(folder_ / "run/winner/aspect.png", folder_ / "alone.png");
  write_file(folder_ / "my.toml", read_file(folder_ / "run/winner/scene.toml"));
  const std::string real = "photo/baseline/image.tif";
  const Json alone = json_of(folder_, {"compare", "alone.png", real, "--out", "out"});
  for (const Json& edge : alone["pairs"][0]["edges"]) {
    EXPECT_FALSE(edge.contains("surface")) << edge;
  }
  const Json with_scene =
      json_of(folder_, {"compare", "alone.png", real, "--scene", "my.toml", "--out", "with_scene"});
  const Json& pair = with_scene["pairs"][0];
  ASSERT_FALSE(pair["edges"].empty()) << pair["notes"];
  for (const Json& edge : pair["edges"]) {
    EXPECT_TRUE(edge.contains("surface")) << edge;
  }
  const Json equal = json_of(
      folder_,
      {"compare", "alone.png", "alone.png", "--scene", "my.toml", "--refine", "--out", "equal"});
  EXPECT_THAT(equal["notes"].dump(), HasSubstr("no cause was found beyond noise"));
  const ProgramResult refused = glint_in(
      folder_, {"compare", "run/winner", real, "--scene", "my.toml", "--quiet", "--out", "other"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("come with a scene of their own"));
  const ProgramResult idle = glint_in(folder_, {"compare", "alone.png", real, "--roughness"});
  EXPECT_EQ(idle.code, 2);
  EXPECT_THAT(idle.err, HasSubstr("--roughness: no simulated picture is known with its scene"));
}

// The plate lies turned and to the right of the middle, in the mirrored photograph to the left:
// nothing that moves the part a little lays its edges there.
TEST_F(CompareVerb, NamesNoCauseForEdgesOfAMirroredPhotograph) {
  write_file(folder_ / "scene.toml",
             edited(kDentedPlate,
                    {{"[part]", "[part]\nposition_mm = [0.7, 0, 0]\nrotation_deg = [0, 0, 25]"}}));
  const ProgramResult rendered =
      glint_in(folder_, {"render", "scene.toml", "--quiet", "--out", "view"});
  ASSERT_EQ(rendered.code, 0) << rendered.err;
  const ImageF view = linear_values(read_picture(folder_ / "view/baseline/image.tif").pixels);
  ImageF mirrored = view;
  for (int y = 0; y < view.height(); ++y) {
    for (int x = 0; x < view.width(); ++x) {
      mirrored(x, y) = view(view.width() - 1 - x, y);
    }
  }
  write_png(folder_ / "mirrored.png", mirrored, PixelDepth::k16Bit);
  const Json result =
      json_of(folder_, {"compare", "view/baseline", "mirrored.png", "--out", "out"});
  const Json& pair = result["pairs"][0];
  EXPECT_THAT(result["verdict"].get<std::string>(),
              HasSubstr("The real picture seems to be mirrored from left to right"));
  EXPECT_THAT(pair["notes"].dump(), HasSubstr("No cause is named for edges"));
  for (const Json& cause : pair["causes"]) {
    EXPECT_EQ(cause["of"], "grey") << cause;
  }
  EXPECT_TRUE(pair["inspection"]["moved"].is_null()) << pair["inspection"];
  EXPECT_THAT(pair["inspection"]["notes"].dump(),
              HasSubstr("inspected where the simulated picture has it"));
}

// The same bytes for any number of threads.
TEST_F(CompareVerb, WritesTheSameForAnyNumberOfThreads) {
  draw("simulated.png", {});
  draw("photos/1.png", {.shift_x_px = 0.3, .index = 1});
  draw("photos/2.png", {.scale = 1.01, .index = 2});
  for (const char* threads : {"1", "3"}) {
    json_of(folder_,
            {"compare",
             "simulated.png",
             "photos",
             "--threads",
             threads,
             "--out",
             std::string("out") + threads});
  }
  expect_same_files(folder_ / "out1", folder_ / "out3");
}

}  // namespace
}  // namespace glint::test
