// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint frontier` on small input.
#include <nlohmann/json.hpp>
#include <set>

#include "tests/cli/program.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;
using ::testing::HasSubstr;

/// A scene of 120 x 36 pixels: 256 rays a pixel in well under a second.
std::string frontier_study_text() {
  return edited(small_study(),
                {{"width_px = 200", "width_px = 120"},
                 {"height_px = 60", "height_px = 36"},
                 {"object_pixel_mm = 0.2", "object_pixel_mm = 0.3333"}});
}

TEST(FrontierVerb, PrintsTheObjectOfItsFile) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", frontier_study_text());
  const ProgramResult result =
      glint_in(folder, {"frontier", "study.toml", "--out", "f", "--json", "--quiet"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  Json printed = Json::parse(result.out);
  EXPECT_EQ(printed["schema"], 1);
  EXPECT_EQ(printed["status"], "done");
  EXPECT_EQ(printed["reference"]["rays_per_px"], 256);
  EXPECT_EQ(printed["report"], "f/frontier.html");
  for (const std::string name : {"frontier.json", "frontier.html", "frontier.svg", "run.json"}) {
    EXPECT_TRUE(fs::exists(folder / "f" / name)) << name;
  }
  Json written = Json::parse(read_file(folder / "f/frontier.json"));
  written["report"] = "f/frontier.html";
  written["drawing"] = "f/frontier.svg";
  EXPECT_EQ(printed, written);
  int on_front = 0;
  for (const Json& point : printed["points"]) {
    on_front += point["on_front"].empty() ? 0 : 1;
  }
  EXPECT_GT(on_front, 0);
}

/// Matt steel under a ring light, small.
constexpr const char* kMattPlateScene = R"(schema = 1
[part]
shape = "plate"
length_mm = 40
width_mm = 30
[material]
type = "conductor"
roughness = 0.4
[camera]
width_px = 800
height_px = 600
object_pixel_mm = 0.04
working_distance_mm = 180
[lighting.ring]
mount = "camera"
inner_radius_mm = 30
outer_radius_mm = 60
height_mm = 80
radiance = [2]
[render.paths]
samples = 4
max_reflections = 1
)";

TEST(FrontierVerb, ChartsAPathTracedSceneInItsBudget) {
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", kMattPlateScene);
  const ProgramResult result = glint_in(
      folder, {"frontier", "scene.toml", "--out", "f", "--budget", "1s", "--json", "--quiet"});
  ASSERT_EQ(result.code, 0) << result.err;
  const Json printed = Json::parse(result.out);
  EXPECT_EQ(printed["pixel_factor"], 2);
  EXPECT_EQ(printed["width_px"], 400);
  EXPECT_EQ(printed["reference"]["pictures"], 4);
  EXPECT_GT(printed["reference"]["own_frame_rmse"], 0.0);
  int current = 0;
  int left_out = 0;
  std::set<std::string> methods;
  for (const Json& point : printed["points"]) {
    methods.insert(point["method"].get<std::string>());
    current += point["is_current"].get<bool>() ? 1 : 0;
    left_out += point.contains("problem") ? 1 : 0;
  }
  EXPECT_EQ(methods, (std::set<std::string>{"direct", "paths"}));
  EXPECT_EQ(current, 1);
  EXPECT_GT(left_out, 0) << "1024 samples take longer than a second";
  EXPECT_THAT(read_file(folder / "f/frontier.svg"), HasSubstr("pictures reduced to 400 x 300 px"));
  const ProgramResult wrong =
      glint_in(folder, {"frontier", "scene.toml", "--out", "g", "--budget", "soon"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("--budget soon: must be a duration like 40s, 30m or 8h"));
}

TEST(FrontierVerb, HasHelpWithAnExample) {
  const TemporaryFolder folder;
  const ProgramResult help = glint_in(folder, {"frontier", "--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.out, HasSubstr("Example:\n  glint frontier "));
}

TEST(FrontierVerb, ChartsTheInspectorBesideTheMethods) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", frontier_study_text());
  const Arguments call = {"frontier", "study.toml", "--inspector", "--out", "f", "--budget", "2s"};
  Arguments as_json = call;
  as_json.insert(as_json.end(), {"--json", "--quiet"});
  const ProgramResult result = glint_in(folder, as_json);
  ASSERT_EQ(result.code, 0) << result.err;
  Json printed = Json::parse(result.out);
  EXPECT_TRUE(printed["points"][0]["is_current"].get<bool>());
  EXPECT_EQ(printed["points"][0]["curve"].size(), 12U);
  EXPECT_EQ(printed["report"], "f/inspector.html");
  Json written = Json::parse(read_file(folder / "f/inspector.json"));
  written["report"] = "f/inspector.html";
  EXPECT_EQ(printed, written);
  const ProgramResult again = glint_in(folder, call);
  EXPECT_EQ(again.code, 0) << "the folder is the verb's own: " << again.err;
  EXPECT_THAT(again.out, HasSubstr("found at no more than 0.1 false reports a picture"));
}

TEST(FrontierVerb, ChartsSearchesAndGoesOnWithThem) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", frontier_study_text());
  const Arguments call = {"frontier",
                          "study.toml",
                          "--search",
                          "--seeds",
                          "2",
                          "--methods",
                          "random,sbplx",
                          "--out",
                          "f",
                          "--json",
                          "--quiet"};
  const ProgramResult result = glint_in(folder, call);
  ASSERT_EQ(result.code, 0) << result.err;
  const Json printed = Json::parse(result.out);
  EXPECT_EQ(printed["status"], "done");
  ASSERT_EQ(printed["methods"].size(), 2U);
  for (const Json& method : printed["methods"]) {
    EXPECT_EQ(method["runs"].size(), 2U);
    EXPECT_EQ(method["summary"].back()["evaluations"], printed["evaluations"]);
  }
  EXPECT_TRUE(fs::exists(folder / "f/searches/random_1.sqlite"));
  EXPECT_TRUE(fs::exists(folder / "f/search.html"));
  EXPECT_EQ(glint_in(folder, call).out, result.out) << "everything is found in the folder";
}

TEST(FrontierVerb, RefusesChartsThatDoNotGoTogether) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", frontier_study_text());
  const Arguments both = {"frontier", "study.toml", "--search", "--inspector", "--out", "f"};
  EXPECT_EQ(glint_in(folder, both).code, 2);
  EXPECT_EQ(glint_in(folder, {"frontier", "study.toml", "--seeds", "3", "--out", "f"}).code, 2);
  const ProgramResult none = glint_in(
      folder, {"frontier", "study.toml", "--search", "--set", "variables={}", "--out", "f"});
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("a search chart needs [variables] and [objective]"));
  EXPECT_FALSE(fs::exists(folder / "f"));
}

TEST(FrontierVerb, PrintsATableForPeople) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", frontier_study_text());
  const ProgramResult result = glint_in(folder, {"frontier", "study.toml", "--out", "f"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("64 rays a pixel"));
  EXPECT_THAT(result.out, HasSubstr("report: f/frontier.html"));
}

TEST(FrontierVerb, LeavesNoFolderWhenTheSceneIsRefused) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", frontier_study_text());
  const ProgramResult result = glint_in(
      folder, {"frontier", "study.toml", "--out", "a/b", "--set", "lighting.tunnel.length_mm=20"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("20 mm long and smaller than the part"));
  EXPECT_FALSE(fs::exists(folder / "a"));
}

TEST(FrontierVerb, OfARunStandsInItsReport) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", frontier_study_text());
  ASSERT_EQ(glint_in(folder, {"run", "study.toml", "--out", "r", "--quiet"}).code, 0);
  const std::string run_json = read_file(folder / "r/run.json");
  ASSERT_EQ(glint_in(folder, {"frontier", "study.toml", "--out", "r", "--quiet"}).code, 0);
  EXPECT_EQ(read_file(folder / "r/run.json"), run_json);
  EXPECT_EQ(read_file(folder / "r/report.html").find("own choice for pictures"), std::string::npos);
  ASSERT_EQ(glint_in(folder, {"report", "r", "--quiet"}).code, 0);
  EXPECT_THAT(read_file(folder / "r/report.html"), HasSubstr("own choice for pictures"));
}

}  // namespace
}  // namespace glint::test
