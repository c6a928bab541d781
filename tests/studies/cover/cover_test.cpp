// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/text.h"
#include "simulator/geometry/mesh_file/mesh_io.h"
#include "studies/cover/cover_json.h"
#include "studies/cover/cover_page.h"
#include "studies/cover/cover_run.h"
#include "tests/support/page_data.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {
namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Json = nlohmann::ordered_json;

/// A rough plate of 60 x 40 x 2 mm under an even sky, looked at from above and below.
constexpr const char* kPlate = R"(
schema = 1
title = "Plate & two views"
[part]
shape = "plate"
length_mm = 60
width_mm = 40
thickness_mm = 2
[material]
type = "diffuse"
reflectance = [0.5]
[camera]
width_px = 240
height_px = 180
object_pixel_mm = 0.4
working_distance_mm = 300
[[viewpoint]]
position_mm = [0, 0, 300]
direction = [0, 0, -1]
up = [0, 1, 0]
[[viewpoint]]
position_mm = [0, 0, -300]
direction = [0, 0, 1]
up = [0, 1, 0]
[lighting.environment]
[coverage]
points = 2000
samples = 4
)";

class CoverStudy : public ::testing::Test {
 protected:
  Json cover(const std::string& text,
             const fs::path& pod = {},
             SceneUse use = SceneUse::kPictures) {
    write_file(folder_ / "scene.toml", text);
    return cover_study(
        load_study(folder_ / "scene.toml", {}, use),
        {.out = folder_ / "out", .pod = pod, .threads = 2, .progress = Progress::Style::kNone});
  }

  TemporaryFolder folder_;
};

// Top and bottom are 2400 mm2 each of 2 (2400 + 120 + 80) = 5200 mm2.
TEST_F(CoverStudy, TellsWhatTheViewsInspect) {
  const Json result = cover(kPlate);
  EXPECT_EQ(result["schema"], 1);
  EXPECT_EQ(result["status"], "done");
  EXPECT_NEAR(result["c1"].get<double>(), 4800.0 / 5200.0, 1e-3);
  ASSERT_EQ(result["ck"].size(), 2U);
  EXPECT_EQ(result["ck"][0], result["c1"]);
  EXPECT_EQ(result["ck"][1], 0.0);
  ASSERT_EQ(result["views"].size(), 2U);
  EXPECT_EQ(result["views"][1]["name"], "view_02");
  EXPECT_NEAR(result["views"][1]["adds"].get<double>(), 2400.0 / 5200.0, 1e-3);
  EXPECT_NEAR(result["largest_gap_mm2"].get<double>(), 400.0, 5.0);  // the rim, all around
  EXPECT_EQ(result["largest_gap"]["mostly"], "unseen");
  // The rim's middle is that of the plate; nearest to it are the middles of the long sides.
  const Json& place = result["largest_gap"]["place_mm"];
  EXPECT_NEAR(place[0].get<double>(), 0.0, 3.0);
  EXPECT_NEAR(std::abs(place[1].get<double>()), 20.0, 1e-3);
  EXPECT_NEAR(
      result["largest_gap"]["normal"][1].get<double>() * place[1].get<double>(), 20.0, 1e-3);
  // 3 pixels of 0.4 mm 299 / 300 at least, a little more at the corners.
  EXPECT_NEAR(result["smallest_defect"]["median_um"].get<double>(), 1200.0, 10.0);
}

// A hundredth of the light is dark as it is, and bright at the exposure that its pictures have.
TEST_F(CoverStudy, JudgesLightAtTheExposureOfThePictures) {
  std::string dim = kPlate;
  dim.replace(dim.find("[lighting.environment]"),
              std::string("[lighting.environment]").size(),
              "[lighting.environment]\nradiance = [0.01]");
  EXPECT_EQ(cover(dim)["c1"], 0.0);
  EXPECT_NEAR(
      cover(dim + "[sensor]\nexpose_to = 0.9\n")["c1"].get<double>(), 4800.0 / 5200.0, 1e-3);
}

TEST_F(CoverStudy, WritesItsFiles) {
  const Json result = cover(kPlate);
  const fs::path out = folder_ / "out";
  for (const char* name : {"coverage.ply",
                           "views.csv",
                           "result.json",
                           "report.html",
                           "run.json",
                           "study.resolved.toml"}) {
    EXPECT_TRUE(fs::exists(out / name)) << name;
  }
  const Json file = Json::parse(read_file(out / "result.json"));
  EXPECT_EQ(file["c1"], result["c1"]);
  EXPECT_EQ(Json::parse(read_file(out / "run.json"))["verb"], "cover");
  const TriangleMesh mesh = read_mesh(out / "coverage.ply");
  EXPECT_EQ(mesh.num_triangles(), result["points"].get<std::size_t>());
  EXPECT_THAT(read_file(out / "coverage.ply"),
              AllOf(HasSubstr("property uchar red"),
                    HasSubstr("property int views\nproperty float smallest_defect_um\n"
                              "property float incidence_deg\nproperty float lit_share\n"
                              "property float pixel_um\n")));
  const std::string html = read_file(out / "report.html");
  EXPECT_THAT(html, AllOf(HasSubstr("the whole surface"), HasSubstr("only light")));
  const Json page = test::page_data(html);
  EXPECT_EQ(page["coverage"]["views"].size(), 2U);
  EXPECT_EQ(page["coverage"]["pictures"].size(), 5U);
  EXPECT_THAT(page["verdict"]["sentence"].get<std::string>(),
              HasSubstr("92.3 % of the surface is inspected by 2 views"));
  EXPECT_THAT(page["verdict"]["details"].dump(),
              HasSubstr("Found means 3 pixels wide in the finest view of the place "
                        "(coverage.defect_px), whatever the defect's contrast"));
  EXPECT_THAT(read_file(out / "study.resolved.toml"), HasSubstr("[coverage]"));
}

/// One face's properties in coverage.ply.
struct CoveredFace {
  std::int32_t views = 0;
  float smallest_um = 0.0F;
  float incidence_deg = 0.0F;
  float lit_share = 0.0F;
  float pixel_um = 0.0F;
};

/// Faces of 1 + 3 x 4 bytes of corners and 5 x 4 bytes of properties.
std::vector<CoveredFace> covered_faces(const std::string& ply, std::size_t count) {
  constexpr std::size_t kCorners = 13;
  constexpr std::size_t kFace = kCorners + sizeof(CoveredFace);
  std::vector<CoveredFace> faces(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = ply.size() - (count - i) * kFace + kCorners;
    std::memcpy(&faces[i], ply.data() + at, sizeof(CoveredFace));
  }
  return faces;
}

// The upper camera's axis is (0, 0, -1); a plate's corner at (30, 20) mm lies atan(36.1 / 299) =
// 6.9 degrees beside it. A pixel there is 0.4 mm 299 / 300 in the middle.
TEST_F(CoverStudy, WritesTheSmallestDefectOfEachFace) {
  const Json result = cover(kPlate);
  const auto faces =
      covered_faces(read_file(folder_ / "out/coverage.ply"), result["points"].get<std::size_t>());
  std::size_t inspected = 0;
  for (const CoveredFace& face : faces) {
    ASSERT_TRUE(face.views == 0 || face.views == 1);
    EXPECT_NEAR(face.smallest_um, face.views == 0 ? 0.0 : 1200.0, 15.0);
    EXPECT_NEAR(face.pixel_um, face.views == 0 ? 0.0 : 400.0, 5.0);
    EXPECT_LE(face.incidence_deg, 7.0);
    EXPECT_EQ(face.lit_share, face.views == 0 ? 0.0F : 1.0F);
    inspected += face.views > 0 ? 1U : 0U;
  }
  EXPECT_GT(inspected, faces.size() / 2);
  EXPECT_LT(inspected, faces.size());
  const auto steepest = std::ranges::max(faces, {}, &CoveredFace::incidence_deg);
  EXPECT_GT(steepest.incidence_deg, 6.0);
}

TEST_F(CoverStudy, GivesTheSameBytesAgain) {
  cover(kPlate);
  const std::string result = read_file(folder_ / "out/result.json");
  const std::string ply = read_file(folder_ / "out/coverage.ply");
  cover(kPlate);
  EXPECT_EQ(read_file(folder_ / "out/result.json"), result);
  EXPECT_EQ(read_file(folder_ / "out/coverage.ply"), ply);
}

TEST_F(CoverStudy, ChoosesAmongItsViews) {
  const Json result = cover(std::string(kPlate) + "choose = 1\nchoice = \"exact\"\n");
  EXPECT_EQ(result["views"].size(), 1U);
  EXPECT_EQ(result["choice"]["candidates"], 2);
  EXPECT_EQ(result["choice"]["method"], "exact");
  EXPECT_EQ(result["choice"]["proven"], true);
  EXPECT_NEAR(result["c1"].get<double>(), 2400.0 / 5200.0, 1e-3);
  EXPECT_THAT(read_file(folder_ / "out/views.csv"), HasSubstr("\nview_02,"));
}

// Branch and bound that was cut short was no greedy choice.
TEST_F(CoverStudy, SaysHowItsViewsWereChosen) {
  Json result = cover(std::string(kPlate) + "choose = 1\nchoice = \"exact\"\n");
  const auto details = [&] {
    return test::page_data(
               cover_page({.result = result, .legend = {}, .pictures = {}}))["verdict"]["details"]
        .dump();
  };
  EXPECT_THAT(details(), HasSubstr("no other choice of as many inspects more"));
  result["choice"]["proven"] = false;
  EXPECT_THAT(details(), HasSubstr("by branch and bound, which ended before"));
  result["choice"]["method"] = "greedy";
  EXPECT_THAT(details(), HasSubstr("one after the other, each that which adds most"));
}

// a90 of 2 mm where a pixel was 0.2 mm: 4 mm where one is 0.4 mm, more than 3 pixels.
TEST_F(CoverStudy, FollowsAStudyOfDetection) {
  fs::create_directory(folder_ / "pod");
  write_file(folder_ / "pod/result.json",
             R"({"pod": {"size": "diameter_mm", "designs": {
               "baseline": {"fit": {"a90": {"value": 2.5}}},
               "best": {"fit": {"a90": {"value": 2.0}}},
               "never": {"fit": null}}}})");
  write_file(folder_ / "pod/study.resolved.toml",
             "[camera]\nobject_pixel_mm = 0.2\nworking_distance_mm = 300\n");
  const Json result = cover(kPlate, folder_ / "pod");
  EXPECT_EQ(result["pod"]["design"], "best");
  EXPECT_NEAR(result["smallest_defect"]["median_um"].get<double>(), 4000.0, 40.0);
  EXPECT_THAT(
      test::page_data(read_file(folder_ / "out/report.html"))["verdict"]["details"].dump(),
      AllOf(HasSubstr("what the design best finds nine times of ten (2000 \u00b5m, a pixel being "),
            HasSubstr("contrast counts as on the parts of that study")));
  const auto faces =
      covered_faces(read_file(folder_ / "out/coverage.ply"), result["points"].get<std::size_t>());
  const auto finest = std::ranges::max(faces, {}, &CoveredFace::smallest_um);
  EXPECT_NEAR(finest.smallest_um, 4000.0, 60.0);
  // The best design is a prototype whose camera sees twice as finely: 2 mm are 20 of its pixels.
  make_folder(folder_ / "pod/best");
  write_file(folder_ / "pod/best/scene.toml",
             "[camera]\nobject_pixel_mm = 0.1\nworking_distance_mm = 300\n");
  EXPECT_NEAR(
      cover(kPlate, folder_ / "pod")["smallest_defect"]["median_um"].get<double>(), 8000.0, 80.0);
}

TEST_F(CoverStudy, RefusesAStudyOfDetectionThatIsNone) {
  fs::create_directory(folder_ / "pod");
  const auto with = [&](const char* json) {
    write_file(folder_ / "pod/result.json", json);
    return [&] { read_pod(folder_ / "pod"); };
  };
  EXPECT_THROW(read_pod(folder_ / "nowhere"), IoError);
  EXPECT_THAT(with("no json"), ThrowsMessage<ConfigError>(HasSubstr("folder of a run with [pod]")));
  EXPECT_THAT(with(R"({"status": "done"})"), ThrowsMessage<ConfigError>(HasSubstr("[pod]")));
  EXPECT_THAT(with(R"({"pod": {"size": "height_um", "designs": {}}})"),
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("height_um"), HasSubstr("diameter_mm"))));
  EXPECT_THAT(with(R"({"pod": {"size": "width_mm", "designs": {"a": {"fit": null}}}})"),
              ThrowsMessage<ConfigError>(HasSubstr("a90")));
}

TEST_F(CoverStudy, RefusesKeysOutOfTheirRangeWithTheirPlace) {
  const auto refused = [&](const std::string& line) {
    return [this, line] { cover(std::string(kPlate) + line + "\n"); };
  };
  EXPECT_THAT(refused("max_incidence_deg = 95"),
              ThrowsMessage<ConfigError>(
                  AllOf(HasSubstr("scene.toml:29"), HasSubstr("coverage.max_incidence_deg"))));
  EXPECT_THAT(refused("max_incidence_deg = 0"), ThrowsMessage<ConfigError>(HasSubstr("(0, 90]")));
  EXPECT_THAT(refused("min_grey = 0.99"),
              ThrowsMessage<ConfigError>(HasSubstr("must not be greater than max_grey")));
  EXPECT_THAT(refused("chose = 2"), ThrowsMessage<ConfigError>(HasSubstr("\"choose\"")));
  EXPECT_THAT(refused("choice = \"best\""), ThrowsMessage<ConfigError>(HasSubstr("\"exact\"")));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(CoverStudy, RefusesACameraInThePartWithItsPlace) {
  std::string text = kPlate;
  text.replace(text.find("[0, 0, -300]"), 12, "[0, 0, 0.5]");
  EXPECT_THAT([&] { cover(text); },
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("scene.toml"), HasSubstr("viewpoint.1"))));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

/// A mirror plate under a semicylinder of 100 mm radius and 120 mm length; the cameras look
/// straight down.
constexpr const char* kMirror = R"(
schema = 1
[part]
shape = "plate"
length_mm = 100
width_mm = 40
thickness_mm = 2
[camera]
width_px = 240
height_px = 180
object_pixel_mm = 0.8
working_distance_mm = 400
[scan]
positions = 8
step_mm = 1.4
[lighting.tunnel]
shape = "semicylinder"
radius_mm = 100
length_mm = 120
slot_mm = 20
blocks_view = false
[coverage]
points = 2000
)";

std::string view_from_above(int x_mm) {
  return "[[viewpoint]]\nposition_mm = [" + std::to_string(x_mm) +
         ", 0, 400]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\n";
}

// From x = -80 mm mirrored rays meet the wall about 20 mm further in x than from above the middle.
// The plate's end at x = -50 shows light at half of the tunnel's eight positions then, which from
// the middle begins some millimetres further in; the picture ends at x = 16 mm.
TEST_F(CoverStudy, LooksAtAMirrorUnderATunnelFromEachOfItsViews) {
  const std::string both = kMirror + view_from_above(0) + view_from_above(-80);
  const Json first = cover(kMirror + view_from_above(0), {}, SceneUse::kCoverage);
  const Json second = cover(kMirror + view_from_above(-80), {}, SceneUse::kCoverage);
  const Json result = cover(both, {}, SceneUse::kCoverage);
  ASSERT_EQ(result["views"].size(), 2U);
  const auto sees = [&](std::size_t view) { return result["views"][view]["sees"].get<double>(); };
  EXPECT_NEAR(sees(0), first["c1"].get<double>(), 1e-12);
  EXPECT_NEAR(sees(1), second["c1"].get<double>(), 1e-12);
  EXPECT_GT(result["views"][0]["only"].get<double>(), 0.01);
  EXPECT_GT(result["views"][1]["only"].get<double>(), 0.01);
  EXPECT_THAT([&] { cover(both); },
              ThrowsMessage<ConfigError>(HasSubstr("a scan has exactly one [[viewpoint]]")));
}

TEST_F(CoverStudy, LeavesTheFolderOfAnotherVerbAlone) {
  fs::create_directory(folder_ / "out");
  write_file(folder_ / "out/run.json", R"({"verb": "render"})");
  EXPECT_THAT([&] { cover(kPlate); },
              ThrowsMessage<ConfigError>(HasSubstr("holds results of `glint render`")));
}

TEST_F(CoverStudy, LeavesTheFolderOfAnotherStudyAlone) {
  fs::create_directory(folder_ / "out");
  write_file(folder_ / "out/run.json", R"({"verb": "cover", "study": "gear"})");
  EXPECT_THAT([&] { cover(kPlate); },
              ThrowsMessage<ConfigError>(HasSubstr("holds results of `glint cover` of gear")));
}

}  // namespace
}  // namespace glint
