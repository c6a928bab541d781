// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/error.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/scene_picture.h"
#include "tests/studies/scene_from.h"

namespace glint {
namespace {

SceneSettings scene_of(const std::string& lighting) {
  return test::scene_from(R"(
[part]
length_mm = 60
width_mm = 30
radius_along_mm = 300
radius_across_mm = 40
[camera]
width_px = 120
height_px = 60
object_pixel_mm = 0.5
working_distance_mm = 300
[sensor]
bits = 0
expose_to = 0.9
[scan]
positions = 4
[render.paths]
samples = 16
)" + lighting);
}

/// The value that so many of 100 pixels of the region do not exceed, over all frames.
double percentile(SceneStore& store, const SceneSettings& scene, std::size_t percent = 99) {
  const auto picture = picture_of(store, scene, {.has_flawless = false});
  const Mask& region = picture->traced()->region.mask;
  std::vector<float> values;
  const auto watch = [&](int, const ImageF& grey) {
    for (std::size_t i = 0; i < region.size(); ++i) {
      if (region.values()[i] != 0) {
        values.push_back(grey.values()[i]);
      }
    }
  };
  picture->mean({.watch = watch, .has_whole_frames = true});
  std::ranges::sort(values);
  return values.empty() ? 0.0 : static_cast<double>(values[values.size() * percent / 100]);
}

const std::string kTunnel = "[lighting.tunnel]\nradius_mm = 120\nslot_mm = 24\n";

TEST(EqualExposure, BringsKindsOfLightToTheSameGrey) {
  ThreadPool pool(2);
  SceneStore store(pool);
  for (const std::string use : {"tunnel", "dome"}) {
    SCOPED_TRACE(use);
    const SceneSettings scene = scene_of(kTunnel + "[lighting.dome]\nradiance = [40]\n");
    std::vector<Problem> errors;
    SceneSettings one = scene;
    reread_scene(
        write_scene(scene), parse_toml("lighting_use = \"" + use + "\"", "use.toml"), one, errors);
    ASSERT_TRUE(errors.empty()) << errors.front().message();
    EXPECT_NEAR(percentile(store, one), 0.9, 0.01);
  }
}

// Under even light all percentiles are the same; a bar from the side tells them apart.
TEST(EqualExposure, MeansTheBrightestPercent) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = scene_of(R"(
[material]
type = "conductor"
roughness = 0.4
[lighting.bar]
position_mm = [0, -100, 80]
direction = [0, 1, 1]
length_mm = 120
width_mm = 25
)");
  EXPECT_NEAR(percentile(store, scene), 0.9, 0.01);
  EXPECT_LT(percentile(store, scene, 90), 0.85);
}

// A brighter light is no better a light.
TEST(EqualExposure, ScoresDoNotDependOnRadiance) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const Scores dim = evaluate(store, scene_of("[lighting.dome]\nradiance = [0.5]\n")).scores;
  const Scores bright = evaluate(store, scene_of("[lighting.dome]\nradiance = [50]\n")).scores;
  EXPECT_NEAR(dim.at("homogeneity.mean"), bright.at("homogeneity.mean"), 1e-5);
  EXPECT_NEAR(dim.at("homogeneity.h_rms"), bright.at("homogeneity.h_rms"), 1e-5);
  SceneSettings fixed = scene_of("[lighting.dome]\nradiance = [0.5]\n");
  fixed.expose_to = 0.0;
  EXPECT_NE(evaluate(store, fixed).scores.at("homogeneity.mean"), dim.at("homogeneity.mean"));
}

TEST(EqualExposure, RefusesLightThatDoesNotReachTheRegion) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings dark = scene_of("[lighting.dome]\nradiance = [0]\n");
  try {
    with_equal_exposure(store, dark);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("sensor.expose_to"));
  }
}

}  // namespace
}  // namespace glint
