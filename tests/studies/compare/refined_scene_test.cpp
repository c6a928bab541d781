// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/refined_scene.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/rng.h"
#include "core/thread_pool.h"
#include "core/units.h"
#include "studies/imaging/scene_picture.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint {
namespace {

/// A rough plate of half reflectance under an even sky of radiance 1 that fills the picture's
/// middle: grey 0.5 at an exposure of 1.
constexpr const char* kGreyPlate = R"(schema = 1
[part]
shape = "plate"
length_mm = 16
width_mm = 12
[material]
type = "diffuse"
reflectance = [0.5]
[camera]
width_px = 40
height_px = 30
object_pixel_mm = 0.6
working_distance_mm = 100
[sensor]
exposure = 0.7
gain = 1.1
expose_to = 0.9
[render.paths]
samples = 256
[lighting.environment]
)";

class RefinedExposure : public CompareFiles {
 protected:
  /// @param picture  that the scene was rendered to
  SceneSettings refined(const std::string& picture,
                        double gain,
                        const std::string& sensor = "",
                        double roughness_change = 0.0) {
    std::string plate = kGreyPlate;
    plate.insert(plate.find("[render.paths]"), sensor);
    write_file(folder() / "scene.toml", plate);
    const CompareSource source = {
        .name = "s", .picture = folder() / picture, .scene = folder() / "scene.toml"};
    PairCauses causes;
    causes.gain = gain;
    causes.roughness_change = roughness_change;
    std::vector<Problem> errors;
    SceneSettings scene =
        read_scene(parse_toml(refined_toml(source, causes, store_), "refined.toml"), errors);
    EXPECT_TRUE(errors.empty());
    return scene;
  }

  ThreadPool pool_{2};
  SceneStore store_{pool_};
};

// `glint render` shows views as sensor.exposure says, whatever expose_to is.
TEST_F(RefinedExposure, OfAViewIsItsOwnTimesTheGain) {
  const SceneSettings scene = refined("image.tif", 1.2);
  EXPECT_EQ(scene.expose_to, 0.0);
  EXPECT_EQ(scene.sensor.exposure, 0.7);
  EXPECT_NEAR(scene.sensor.gain, 1.1 * 1.2, 1e-12);
}

TEST_F(RefinedExposure, OfADesignIsWhatItIsExposedTo) {
  const SceneSettings scene = refined("aspect.png", 0.8);
  const double dark = dark_grey(scene.sensor);
  EXPECT_NEAR(scene.expose_to, dark + 0.8 * (0.9 - dark), 1e-12);
  EXPECT_EQ(scene.sensor.gain, 1.1);
}

// 1.2 times 0.9 is beyond full scale: only an exposure says it, and it is that of the 99th
// percentile of the plate, 0.9, times the gain.
TEST_F(RefinedExposure, OfADesignBeyondFullScaleIsAnExposure) {
  const SceneSettings scene = refined("aspect.png", 1.2);
  EXPECT_EQ(scene.expose_to, 0.0);
  const double grey = 0.5 * scene.sensor.exposure * scene.sensor.gain;
  EXPECT_NEAR(grey, 1.2 * (0.9 - dark_grey(scene.sensor)), 0.2);
  EXPECT_GT(grey, 0.9);
}

constexpr const char* kDarkSensor = "full_well_e = 10000\ndark_e = 1000\n";

// The dark signal is there without light: more light leaves it as it is, a gain would not.
TEST_F(RefinedExposure, LeavesTheDarkSignalAlone) {
  const SceneSettings view = refined("image.tif", 1.2, kDarkSensor);
  EXPECT_NEAR(view.sensor.exposure, 0.7 * 1.2, 1e-12);
  EXPECT_EQ(view.sensor.gain, 1.1);
  const SceneSettings design = refined("aspect.png", 0.8, kDarkSensor);
  EXPECT_NEAR(dark_grey(design.sensor), 0.11, 1e-12);
  EXPECT_NEAR(design.expose_to, 0.11 + 0.8 * (0.9 - 0.11), 1e-12);
}

// Metal of another roughness is darker or brighter at one exposure, which is what was found:
// brought to a level it would be as bright as before.
TEST_F(RefinedExposure, OfADesignOfOtherMetalIsAnExposure) {
  const double level = 0.9;  // of the design's brightest per cent, nearly that of all its pixels
  for (const std::string& sensor : {std::string(), std::string(kDarkSensor)}) {
    const SceneSettings scene = refined("aspect.png", 0.8, sensor, 0.05);
    EXPECT_EQ(scene.expose_to, 0.0);
    const double grey = 0.5 * scene.sensor.exposure * scene.sensor.gain;
    EXPECT_NEAR(grey, 0.8 * (level - dark_grey(scene.sensor)), 0.1);
  }
}

/// A view of the plate from one side, whose edges say that the lens is one pixel longer.
RefinedView view_with_longer_lens(double side_mm, double gain, std::uint64_t index) {
  std::vector<Problem> errors;
  RefinedView view = {.scene = read_scene(parse_toml(kGreyPlate, "scene.toml"), errors)};
  view.scene.expose_to = 0.0;
  view.scene.viewpoint().position_mm = {side_mm, 0.0, 100.0};
  const PinholeIntrinsics camera = intrinsics_of(view.scene);
  CauseFit fit = {.noise_px = 0.02};
  fit.causes.push_back({.parameter = CauseParameter::kFocalLength, .value = 1.0});
  fit.changes[static_cast<std::size_t>(CauseParameter::kFocalLength)] = 1.0;
  view.causes.middle_mm = {0.0, 0.0, 100.0};
  view.causes.gain = gain;
  Rng rng(23, Stream::kTest, index);
  for (int i = 0; i < 400; ++i) {
    const double angle = rng.uniform(0.0, 2.0 * kPi);
    SpaceEdge edge = {.in_camera_mm = {rng.uniform(-11.0, 11.0),
                                       rng.uniform(-8.0, 8.0),
                                       100.0 + rng.uniform(-20.0, 20.0)},
                      .normal = {std::cos(angle), std::sin(angle)}};
    edge.offset_px = edge.normal.dot(
        changed_pixel(camera, view.causes.middle_mm, fit.changes, edge.in_camera_mm) -
        changed_pixel(camera, view.causes.middle_mm, CauseVector{}, edge.in_camera_mm));
    view.causes.space_edges.push_back(edge);
  }
  view.causes.edges = fit;
  return view;
}

TEST(JointlyRefined, HasAllViewsAndOneLens) {
  const std::vector<RefinedView> views = {view_with_longer_lens(0.0, 1.1, 1),
                                          view_with_longer_lens(30.0, 1.3, 2),
                                          view_with_longer_lens(-30.0, 1.2, 3)};
  const auto joint = jointly_refined(views);
  ASSERT_TRUE(joint.has_value());
  ASSERT_EQ(joint->viewpoints.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(
        joint->viewpoints[i].position_mm[0], views[i].scene.viewpoint().position_mm[0], 0.1);
  }
  EXPECT_NEAR(
      intrinsics_of(*joint).focal_px.x(), intrinsics_of(views[0].scene).focal_px.x() + 1.0, 0.1);
  EXPECT_EQ(joint->expose_to, 0.0);
  EXPECT_NEAR(joint->sensor.gain, 1.1 * 1.2, 1e-9);
}

// Gains are what is left beside the roughness that was found: without it they would be of another
// scene.
TEST(JointlyRefined, HasTheMedianOfRoughnessBesideThatOfGains) {
  std::vector<RefinedView> views = {view_with_longer_lens(0.0, 1.1, 1),
                                    view_with_longer_lens(30.0, 1.3, 2),
                                    view_with_longer_lens(-30.0, 1.2, 3)};
  const double own = views[0].scene.material.roughness;
  const std::vector<double> changes = {0.05, 0.0, 0.03};  // one view does not tell it
  for (std::size_t i = 0; i < views.size(); ++i) {
    views[i].causes.roughness_change = changes[i];
  }
  const auto joint = jointly_refined(views);
  ASSERT_TRUE(joint.has_value());
  EXPECT_NEAR(joint->material.roughness, own + 0.04, 1e-12);
  EXPECT_NEAR(joint->sensor.gain, 1.1 * 1.15, 1e-9) << "of the views that tell the roughness";
}

TEST(JointlyRefined, IsNothingForOneViewOrForOtherScenes) {
  const RefinedView view = view_with_longer_lens(0.0, 1.0, 1);
  RefinedView other = view_with_longer_lens(30.0, 1.0, 2);
  EXPECT_FALSE(jointly_refined(std::vector{view}));
  EXPECT_FALSE(jointly_refined(std::vector{view, view}));
  EXPECT_TRUE(jointly_refined(std::vector{view, other}));
  other.scene.part.length_mm = 17.0;
  EXPECT_FALSE(jointly_refined(std::vector{view, other}));
  other = view_with_longer_lens(30.0, 1.0, 2);
  other.causes.space_edges.clear();  // doubtful ones
  EXPECT_FALSE(jointly_refined(std::vector{view, other}));
}

}  // namespace
}  // namespace glint
