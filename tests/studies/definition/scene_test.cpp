// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/scene.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/key_writer.h"
#include "core/config/toml.h"
#include "studies/evaluation/evaluation.h"

namespace glint {
namespace {

SceneSettings read_scene_text(const std::string& text, std::vector<Problem>& errors) {
  return read_scene(parse_toml(text, "scene.toml"), errors);
}

/// A strip under a semicylinder, small enough to trace in milliseconds.
SceneSettings small_scene() {
  std::vector<Problem> errors;
  SceneSettings scene = read_scene_text(R"(
[part]
length_mm = 60
width_mm = 30
radius_along_mm = 300
radius_across_mm = 40
[camera]
width_px = 200
height_px = 100
object_pixel_mm = 0.3
working_distance_mm = 300
[sensor]
gain = 1.5
[lighting.tunnel]
radius_mm = 120
slot_mm = 24
[defects.dent]
x_mm = [-12, 12]
y_mm = [8, -8]
height_um = 8
diameter_mm = 1.6
)",
                                        errors);
  EXPECT_TRUE(errors.empty()) << (errors.empty() ? "" : errors.front().message());
  return scene;
}

TEST(Scene, WritingAndReadingBackGivesTheSameScene) {
  const ConfigNode written = write_scene(small_scene());
  std::vector<Problem> errors;
  const ConfigNode again = write_scene(read_scene_text(to_toml(written), errors));
  EXPECT_TRUE(errors.empty()) << (errors.empty() ? "" : errors.front().message());
  EXPECT_EQ(to_toml(written), to_toml(again));
}

TEST(Scene, EveryKeyOfTheTableIsWritten) {
  SceneSettings scene = small_scene();
  scene.defects.clear();
  for (const char* name : {"dent", "bump", "scratch", "pit", "gouge", "stain"}) {
    scene.defects.emplace_back(name, DefectGroup{});
  }
  for (const std::string_view type : light_types()) {
    scene.lights.push_back({.name = std::string(type), .settings = default_light(type).value()});
  }
  scene.calibration = {.flange_from_camera = MeasuredPoseSettings{},
                       .base_from_camera = MeasuredPoseSettings{},
                       .covariance = CovarianceSettings{}};
  scene.cell = {.base_from_part = MeasuredPoseSettings{},
                .flange_from_part = MeasuredPoseSettings{}};
  scene.reference.emplace();
  scene.validate = ValidateSettings{};
  scene.has_coverage = true;
  scene.cost = CostSettings{
      .exposure_s = 0.01, .move_s = 0.1, .per_mm2 = 0.02, .per_led = 0.5, .per_frame = 0.0};
  scene.paths.has_bias_taken_off = true;
  const ConfigNode written = write_scene(scene);
  scene.viewpoint().base_from_flange.emplace();
  const ConfigNode by_flange = write_scene(scene);
  for (const KeyRow& row : scene_keys()) {
    EXPECT_TRUE(written.at_path(row.path) != nullptr || by_flange.at_path(row.path) != nullptr)
        << row.path;
    EXPECT_FALSE(row.doc.empty()) << row.path;
  }
}

TEST(Scene, ATableOfCoverageIsWrittenWhereThereIsOne) {
  std::vector<Problem> errors;
  const SceneSettings without = read_scene_text("[part]\n", errors);
  EXPECT_EQ(write_scene(without).find("coverage"), nullptr);
  const SceneSettings with = read_scene_text("[coverage]\nmax_incidence_deg = 45\n", errors);
  ASSERT_TRUE(errors.empty());
  EXPECT_NEAR(with.coverage.max_incidence_rad, 0.25 * kPi, 1e-12);
  ASSERT_NE(write_scene(with).at_path("coverage.max_incidence_deg"), nullptr);
  EXPECT_NEAR(write_scene(with).at_path("coverage.max_incidence_deg")->number, 45.0, 1e-9);
}

TEST(Scene, TwoTunnelsAreAnErrorWithItsPlace) {
  std::vector<Problem> errors;
  read_scene_text("[lighting.a]\n[lighting.b]\n", errors);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0].message(),
              ::testing::HasSubstr("scene.toml:2:11: lighting.b: is a second tunnel"));
}

TEST(WithPlace, FindsTheKeyTheTableOrTheFile) {
  ConfigNode root = parse_toml("[part]\nlength_mm = 3\n", "s.toml");
  root.place.file = "s.toml";
  const auto placed = [&](const ConfigError& error) {
    return std::string(with_place(root, error).what());
  };
  EXPECT_EQ(placed(ConfigError("part.length_mm", "is 3")), "s.toml:2:1: part.length_mm: is 3");
  EXPECT_EQ(placed(ConfigError("part.width_mm", "is 3")), "s.toml:1:2: part.width_mm: is 3");
  EXPECT_EQ(placed(ConfigError("camera", "is away")), "s.toml: camera: is away");
  EXPECT_EQ(placed(ConfigError("gear.stl: is empty")), "gear.stl: is empty");
  EXPECT_EQ(placed(ConfigError("part.length_mm: is a text, not a key")),
            "part.length_mm: is a text, not a key");
}

TEST(InContext, StandsBeforeEveryKeyBehindItsPlace) {
  const Place place = {.file = "s.toml", .line = 2, .column = 1};
  const ConfigError error(std::vector<Problem>{
      {.place = place, .key = "part.length_mm", .text = "is 3"}, {.text = "no key"}});
  EXPECT_STREQ(
      in_context(in_context(error, "prototypes.a"), "part_3").what(),
      "s.toml:2:1: part_3: prototypes.a: part.length_mm: is 3\npart_3: prototypes.a: no key");
}

TEST(Evaluation, ScoresAreTheSameForAnyNumberOfThreads) {
  const SceneSettings scene = small_scene();
  ThreadPool one(1);
  ThreadPool two(2);
  SceneStore first(one);
  SceneStore second(two);
  EXPECT_EQ(evaluate(first, scene).scores, evaluate(second, scene).scores);
}

TEST(Evaluation, LightingAloneTracesNothingAgain) {
  ThreadPool pool(1);
  SceneStore store(pool);
  SceneSettings scene = small_scene();
  evaluate(store, scene);
  scene.tunnel.radius_mm = 130.0;
  scene.sensor.gain = 2.0;
  evaluate(store, scene);
  EXPECT_EQ(store.num_traced(), 1);
  scene.defects[0].second.height_mm = 2.0 * scene.defects[0].second.height_mm.max;
  evaluate(store, scene);
  EXPECT_EQ(store.num_traced(), 2);
}

// A closed scan's mean image is right in the region alone; who takes frames gets their mean
// everywhere: what is written to disk shows the whole picture.
TEST(Evaluation, TheAspectImageIsThatOfAllFramesWhereTheyAreTaken) {
  ThreadPool pool(1);
  SceneStore store(pool);
  for (const auto method : {RenderSettings::Method::kAuto, RenderSettings::Method::kClosed}) {
    SceneSettings scene = small_scene();
    scene.render.method = method;
    ImageF sum(scene.camera.width_px, scene.camera.height_px);
    const Evaluation evaluation = evaluate(store, scene, [&](int, const ImageF& grey) {
      std::ranges::transform(sum.values(), grey.values(), sum.values().begin(), std::plus<float>());
    });
    int outside = 0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const float mean = sum.values()[i] / static_cast<float>(scene.scan.positions);
      ASSERT_NEAR(evaluation.aspect.values()[i], mean, 1e-5F) << i;
      outside += evaluation.traced->region.mask.values()[i] == 0 && mean > 0.1F ? 1 : 0;
    }
    EXPECT_GT(outside, 0);
  }
}

TEST(Evaluation, DentsStandOutUnderAClippingSensorOnly) {
  ThreadPool pool(1);
  SceneStore store(pool);
  SceneSettings scene = small_scene();
  const double clipped = evaluate(store, scene).scores.at("defects.min_weber");
  scene.sensor.gain = 1.0;
  const double linear = evaluate(store, scene).scores.at("defects.min_weber");
  EXPECT_GT(clipped, 0.02);
  EXPECT_LT(linear, 0.005);
}

TEST(Evaluation, AnAllWhiteImageIsCaughtByItsClippedShare) {
  ThreadPool pool(1);
  SceneStore store(pool);
  SceneSettings scene = small_scene();
  scene.tunnel.duty = 1.0;
  scene.tunnel.slot_mm = 0.0;
  scene.tunnel.blocks_view = false;
  const Scores scores = evaluate(store, scene).scores;
  EXPECT_DOUBLE_EQ(scores.at("homogeneity.h_rms"), 1.0);
  EXPECT_DOUBLE_EQ(scores.at("homogeneity.clipped_share"), 1.0);
  EXPECT_DOUBLE_EQ(scores.at("defects.min_cnr"), 0.0);
}

TEST(Evaluation, APartThatDoesNotFitIntoTheTunnelIsAnError) {
  ThreadPool pool(1);
  SceneStore store(pool);
  SceneSettings scene = small_scene();
  scene.tunnel.radius_mm = 14.0;
  EXPECT_THAT([&] { evaluate(store, scene); },
              ::testing::ThrowsMessage<ConfigError>(
                  ::testing::HasSubstr("the tunnel is smaller than the part")));
}

TEST(Evaluation, ATunnelThatTravelsOffThePartIsAnError) {
  ThreadPool pool(1);
  SceneStore store(pool);
  SceneSettings scene = small_scene();
  scene.scan.step_mm = 100.0;
  EXPECT_THAT([&] { evaluate(store, scene); },
              ::testing::ThrowsMessage<ConfigError>(::testing::StartsWith("scan.step_mm: ")));
}

// Image x runs along world x and image y against world y: the dent at (-12, 8) is seen left of and
// above the middle, at about (100 - 12 / 0.3, 50 - 8 / 0.3) = (60, 23).
TEST(ViewDefects, WindowsLieWhereTheDefectsAre) {
  ThreadPool pool(1);
  SceneStore store(pool);
  const auto traced = store.trace(small_scene());
  const DefectView& view = traced->views[0];
  double best = 1e9;
  int at_x = 0;
  int at_y = 0;
  for (int y = 0; y < view.distance.height(); ++y) {
    for (int x = 0; x < view.distance.width(); ++x) {
      if (static_cast<double>(view.distance(x, y)) < best) {
        best = static_cast<double>(view.distance(x, y));
        at_x = view.left_px + x;
        at_y = view.top_px + y;
      }
    }
  }
  EXPECT_NEAR(at_x, 60, 2);
  EXPECT_NEAR(at_y, 23, 2);
  // A disc of radius 0.8 mm in pixels of 0.3 mm, seen a little larger and a little oblique.
  EXPECT_NEAR(view.area_px, kPi * 0.64 / 0.09, 2.0);
}

}  // namespace
}  // namespace glint
