// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

FoundDefect blob_at(double x_px, double y_px) {
  FoundDefect blob;
  blob.x_px = x_px;
  blob.y_px = y_px;
  return blob;
}

KnownDefect dent(double x_px, double y_px, double radius_px) {
  return {.label = "dent", .from_px = {x_px, y_px}, .to_px = {x_px, y_px}, .radius_px = radius_px};
}

TEST(KnownDefect, MeasuresTheDistanceFromItsLine) {
  const KnownDefect scratch{.from_px = {10, 5}, .to_px = {20, 5}, .radius_px = 1.0};
  EXPECT_DOUBLE_EQ(scratch.distance_px({15, 8}), 3.0);
  EXPECT_DOUBLE_EQ(scratch.distance_px({23, 9}), 5.0);  // 3, 4, 5 from its end
  EXPECT_DOUBLE_EQ(dent(3, 4, 1).distance_px({0, 0}), 5.0);
}

constexpr TrialSettings kTrials = {.hit_radii = 1.5, .echo_px = 0.0};

// Radius 4 and 1.5 radii: 6 px, and 1.5 px more.
TEST(MatchDetections, FindsWithinTheHitRadii) {
  const std::vector<KnownDefect> known = {dent(50, 50, 4)};
  for (const auto& [x_px, is_found] : {std::pair{57.4, true}, {57.6, false}}) {
    const std::vector<FoundDefect> found = {blob_at(x_px, 50)};
    const DetectionMatches comparison = match_detections(found, known, kTrials);
    EXPECT_EQ(comparison.found(), is_found ? 1 : 0);
    EXPECT_EQ(comparison.false_alarms(), is_found ? 0 : 1);
  }
}

// Two blobs of one defect are no false alarms; the nearer one stands for it.
TEST(MatchDetections, GivesEachBlobToTheNearestDefect) {
  const std::vector<KnownDefect> known = {dent(20, 20, 5), dent(30, 20, 5), dent(90, 90, 2)};
  const std::vector<FoundDefect> found = {
      blob_at(24, 20), blob_at(21, 20), blob_at(28, 20), blob_at(60, 60)};
  const DetectionMatches comparison = match_detections(found, known, kTrials);
  EXPECT_THAT(comparison.defect_of_blob, ElementsAre(0, 0, 1, -1));
  EXPECT_THAT(comparison.blob_of_defect, ElementsAre(1, 2, -1));
  EXPECT_EQ(comparison.found(), 2);
  EXPECT_EQ(comparison.false_alarms(), 1);
}

// 7.5 px as above, and 3 px around that: neither a find nor a false alarm.
TEST(MatchDetections, TakesSideLobesForEchoes) {
  const std::vector<KnownDefect> known = {dent(50, 50, 4)};
  const std::vector<FoundDefect> found = {blob_at(60.4, 50), blob_at(50, 60.6)};
  const DetectionMatches comparison =
      match_detections(found, known, {.hit_radii = 1.5, .echo_px = 3.0});
  EXPECT_THAT(comparison.defect_of_blob, ElementsAre(0, -1));
  EXPECT_EQ(comparison.found(), 0);
  EXPECT_EQ(comparison.false_alarms(), 1);
}

/// 100 x 50 pixels of 0.1 mm, seen from above: x to the right, y upwards.
constexpr const char* kScene =
    "[camera]\nwidth_px = 100\nheight_px = 50\nobject_pixel_mm = 0.1\nworking_distance_mm = 500\n";

// The middle of the picture is (50, 25); 1 mm is 10 px. A dent of 78.54 px2 has a radius of 5 px;
// a scratch 21 px long and 1 px wide covers 20 x 1 + pi / 4 = 20.785 px2.
TEST(ReadKnownDefects, ProjectsThemIntoThePicture) {
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", kScene);
  write_file(folder / "defects.json", R"({"schema": 1, "defects": [
    {"id": 0, "label": "dent_1", "kind": "dent", "centre_mm": [0, 0, 0], "area_px": 78.5398163},
    {"id": 1, "label": "scratch_1", "kind": "scratch", "centre_mm": [2, 0, 0],
     "direction": [1, 0, 0], "length_mm": 2.1, "width_mm": 0.1, "area_px": 20.7853982},
    {"id": 2, "label": "dent_2", "kind": "dent", "centre_mm": [80, 0, 0], "area_px": 78.5},
    {"id": 3, "label": "dent_3", "kind": "dent", "centre_mm": [1, 0, -9], "area_px": 0}]})");
  const auto known = read_known_defects(folder / "defects.json", folder / "scene.toml");
  ASSERT_EQ(known.size(), 2U) << "the third lies outside the picture, the fourth on the far side";
  EXPECT_EQ(known[0].label, "dent_1");
  EXPECT_NEAR(known[0].middle_px().x(), 50.0, 0.01);
  EXPECT_NEAR(known[0].middle_px().y(), 25.0, 0.01);
  EXPECT_NEAR(known[0].radius_px, 5.0, 1e-6);
  EXPECT_NEAR((known[1].to_px - known[1].from_px).norm(), 20.0, 0.01);
  EXPECT_NEAR(std::abs(known[1].middle_px().x() - 50.0), 20.0, 0.01);
  EXPECT_NEAR(known[1].radius_px, 0.5, 1e-3);
}

TEST(ReadKnownDefects, SaysWhatIsNoList) {
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", kScene);
  for (const char* text : {"nonsense", "{}", R"({"defects": [{"id": 1}]})"}) {
    write_file(folder / "defects.json", text);
    EXPECT_THAT(text_thrown_by<ConfigError>(
                    [&] { read_known_defects(folder / "defects.json", folder / "scene.toml"); }),
                HasSubstr("defects.json: is no list of defects"));
  }
}

}  // namespace
}  // namespace glint
