// SPDX-License-Identifier: GPL-3.0-or-later
//
// Size, scan time and cost of a scene's lighting, worked by hand.
#include "studies/evaluation/lighting_totals.h"

#include <cmath>

#include <gtest/gtest.h>

#include "studies/evaluation/evaluation.h"
#include "tests/studies/scene_from.h"

namespace glint {
namespace {

constexpr const char* kRingAndBar = R"(
[lighting.ring]
inner_radius_mm = 30
outer_radius_mm = 50
height_mm = 80
leds = 24
led_diameter_mm = 4
[lighting.bar]
length_mm = 300
width_mm = 20
position_mm = [0, 0, 150]
)";

// Semicylinder of 100 mm, 600 long, no slot: area 100 pi times 600. 24 frames of 8 ms and 23 moves
// of 50 ms: 192 + 1150 = 1342 ms. 0.02 a mm2 and 1.5 a frame.
TEST(LightingTotals, OfATunnel) {
  const LightingTotals totals = lighting_totals(test::scene_from(R"(
[lighting.tunnel]
radius_mm = 100
length_mm = 600
slot_mm = 0
[scan]
positions = 24
[cost]
exposure_ms = 8
move_ms = 50
per_mm2 = 0.02
per_frame = 1.5
)"));
  const double area = 100.0 * kPi * 600.0;
  EXPECT_NEAR(totals.size->width_mm, 200.0, 1e-9);
  EXPECT_NEAR(totals.size->height_mm, 100.0, 1e-9);
  EXPECT_NEAR(totals.size->length_mm, 600.0, 1e-9);
  EXPECT_NEAR(totals.size->area_mm2, area, 1e-6 * area);
  EXPECT_EQ(totals.leds, 0);
  EXPECT_EQ(totals.frames, 24);
  EXPECT_NEAR(totals.scan_s.value(), 1.342, 1e-12);
  EXPECT_NEAR(totals.cost.value(), 0.02 * area + 36.0, 1e-6 * area);
}

// LEDs on the circle of 40 mm: the outermost stand 7.5 degrees beside the y axis. Area 24 pi 2^2
// and 300 times 20. One picture without a tunnel: no move.
TEST(LightingTotals, OfRingAndBarTogetherAndOfOneOfThem) {
  const std::string cost = "[cost]\nexposure_ms = 4\nper_led = 0.5\nper_mm2 = 0.001\n";
  const double leds_mm2 = 24.0 * kPi * 4.0;
  const LightingTotals both = lighting_totals(test::scene_from(kRingAndBar + cost));
  EXPECT_NEAR(both.size->length_mm, 300.0, 1e-9);
  EXPECT_NEAR(both.size->width_mm, 2.0 * (40.0 * std::cos(7.5 * kRadPerDeg) + 2.0), 1e-9);
  EXPECT_NEAR(both.size->height_mm, 70.0, 1e-9);
  EXPECT_NEAR(both.size->area_mm2, leds_mm2 + 6000.0, 1e-6);
  EXPECT_EQ(both.leds, 24);
  EXPECT_EQ(both.frames, 1);
  EXPECT_NEAR(both.scan_s.value(), 0.004, 1e-12);
  EXPECT_NEAR(both.cost.value(), 12.0 + 0.001 * (leds_mm2 + 6000.0), 1e-9);
  const LightingTotals bar =
      lighting_totals(test::scene_from("lighting_use = \"bar\"\n" + (kRingAndBar + cost)));
  EXPECT_NEAR(bar.size->area_mm2, 6000.0, 1e-9);
  EXPECT_NEAR(bar.size->width_mm, 20.0, 1e-9);
  EXPECT_EQ(bar.leds, 0);
}

// A tunnel that shines only beside the ring is scanned; the ring alone takes one picture.
TEST(LightingTotals, TheScanIsThatOfTheLightsThatShine) {
  const std::string both = "[scan]\npositions = 8\n[lighting.tunnel]\n[lighting.ring]\n";
  EXPECT_EQ(lighting_totals(test::scene_from(both)).frames, 8);
  EXPECT_EQ(lighting_totals(test::scene_from("lighting_use = \"ring\"\n" + both)).frames, 1);
}

TEST(LightingTotals, ALightOfNoPowerDoesNotCount) {
  const LightingTotals totals =
      lighting_totals(test::scene_from("[lighting.ring]\nradiance = [0]\n[lighting.bar]\n"));
  EXPECT_NEAR(totals.size->area_mm2, 4000.0, 1e-9);
  EXPECT_FALSE(
      lighting_totals(test::scene_from("[lighting.bar]\nradiance = [0]\n")).size.has_value());
}

// The camera stands 100 mm above the part and looks down; the ring on it is 30 mm before it.
TEST(LightingTotals, LightsStandWhereTheyAreMounted) {
  const SceneSettings scene = test::scene_from(R"(
[[viewpoint]]
position_mm = [0, 0, 100]
direction = [0, 0, -1]
[lighting.ring]
mount = "camera"
height_mm = 30
[lighting.bar]
mount = "part"
position_mm = [0, 0, 10]
[part]
position_mm = [0, 0, -5]
)");
  EXPECT_NEAR(lighting_totals(scene).size->height_mm, 70.0 - 5.0, 1e-9);
}

TEST(LightingTotals, WithAnEnvironmentHaveNoSize) {
  SceneSettings scene = test::scene_from(R"(
[lighting.ring]
leds = 12
[lighting.environment]
[cost]
per_led = 2
)");
  const LightingTotals totals = lighting_totals(scene);
  EXPECT_FALSE(totals.size.has_value());
  EXPECT_EQ(totals.leds, 12);
  EXPECT_EQ(totals.cost.value(), 24.0);
  EXPECT_FALSE(totals.scan_s.has_value());
  scene.cost->per_mm2 = 0.1;
  EXPECT_FALSE(lighting_totals(scene).cost.has_value());
}

TEST(LightingTotals, WithoutCostHaveNeitherTimeNorPrice) {
  const LightingTotals totals = lighting_totals(test::scene_from("[lighting.tunnel]\n"));
  EXPECT_FALSE(totals.scan_s.has_value());
  EXPECT_FALSE(totals.cost.has_value());
  Scores scores;
  add_scores(scores, totals);
  EXPECT_EQ(scores.count("scan.time_s") + scores.count("cost.total"), 0U);
  EXPECT_EQ(scores.at("scan.frames"), 24.0);
}

// The part's file is not there, so nothing can have been traced.
TEST(LightingScores, AreEvaluatedWithoutAPicture) {
  SceneSettings scene = test::scene_from("[lighting.tunnel]\nradius_mm = 120\nslot_mm = 0\n");
  scene.part.shape = PartSettings::Shape::kMesh;
  scene.part.file = "no_such_file.stl";
  Goal goal;
  goal.objective = {.name = "lighting.width_mm"};
  goal.constraints = {{.name = "scan.frames", .max = 30.0}};
  const WantedScores wanted = wanted_by(goal);
  EXPECT_TRUE(wanted.lighting);
  EXPECT_FALSE(wanted.picture);
  ThreadPool pool(1);
  SceneStore store(pool);
  const Scores scores = evaluate(store, scene, {}, wanted).scores;
  EXPECT_NEAR(scores.at("lighting.width_mm"), 240.0, 1e-9);
  EXPECT_EQ(scores.at("scan.frames"), 24.0);
  EXPECT_EQ(store.num_traced(), 0);
}

}  // namespace
}  // namespace glint
