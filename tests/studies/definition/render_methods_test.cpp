// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/render_methods.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/definition/ladder/compared_methods.h"

namespace glint {
namespace {

using Method = RenderSettings::Method;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::Pair;

SceneSettings mirror_scene(Method method) {
  SceneSettings scene;
  scene.render.method = method;
  return scene;
}

/// The same with every frame by path tracing.
SceneSettings path_scene() {
  return mirror_scene(Method::kPaths);
}

TEST(FrameMethod, NamesHowFramesComeAbout) {
  EXPECT_EQ(frame_method(mirror_scene(Method::kSampled)).name, "sampled");
  for (const Method method : {Method::kAuto, Method::kIntegrated, Method::kClosed}) {
    EXPECT_EQ(frame_method(mirror_scene(method)).name, "integrated");
    EXPECT_THAT(frame_method(mirror_scene(method)).numbers, IsEmpty());
  }
  SceneSettings scene = path_scene();
  scene.paths.samples = 64;
  scene.paths.batches = 4;
  scene.paths.max_reflections = 3;
  EXPECT_EQ(frame_method(scene).name, "paths");
  EXPECT_THAT(frame_method(scene).numbers,
              ElementsAre(Pair("samples", 64), Pair("batches", 4), Pair("max_reflections", 3)));
}

TEST(FrameMethod, HasAClosedMeanOnlyWhereASearchMayTakeIt) {
  EXPECT_TRUE(frame_method(mirror_scene(Method::kAuto)).has_closed_mean);
  EXPECT_TRUE(frame_method(mirror_scene(Method::kClosed)).has_closed_mean);
  EXPECT_FALSE(frame_method(mirror_scene(Method::kSampled)).has_closed_mean);
  EXPECT_FALSE(frame_method(mirror_scene(Method::kIntegrated)).has_closed_mean);
  EXPECT_FALSE(frame_method(path_scene()).has_closed_mean);
  SceneSettings ring = mirror_scene(Method::kAuto);
  ring.lights = {{.name = "ring", .settings = RingSettings{}}};
  EXPECT_FALSE(frame_method(ring).has_closed_mean) << "auto follows paths here";
}

TEST(RescoringSettings, HaveOtherSeedsAndFourTimesTheSamplesOfPaths) {
  const SceneSettings scene = path_scene();
  const SceneSettings rescored = rescoring_settings(scene);
  EXPECT_TRUE(needs_paths(rescored));
  EXPECT_EQ(rescored.paths.samples, 4 * scene.paths.samples);
  EXPECT_NE(rescored.paths.seed, scene.paths.seed);
  EXPECT_NE(rescored.sensor.seed, scene.sensor.seed);
}

TEST(RescoringSettings, RenderEveryFrameOfAMirror) {
  for (const Method method : {Method::kAuto, Method::kIntegrated, Method::kClosed}) {
    const SceneSettings scene = mirror_scene(method);
    const SceneSettings rescored = rescoring_settings(scene);
    EXPECT_EQ(rescored.render.method, Method::kIntegrated);
    EXPECT_EQ(rescored.render.max_direction_error_rad, 0.25 * scene.render.max_direction_error_rad);
    EXPECT_NE(rescored.sensor.seed, scene.sensor.seed);
  }
  const SceneSettings scene = mirror_scene(Method::kSampled);
  EXPECT_EQ(rescoring_settings(scene).render.method, Method::kSampled);
  EXPECT_EQ(rescoring_settings(scene).render.rays_per_axis, 2 * scene.render.rays_per_axis);
}

TEST(ComparedMethods, AreSettingsOfTheSceneThatDifferInTheMethod) {
  SceneSettings scene;
  scene.render.max_bounces = 7;
  scene.render.max_direction_error_rad = 0.5e-3;
  std::set<std::string> labels;
  std::vector<std::size_t> kinds;
  for (const ComparedMethod& method : compared_methods(scene)) {
    EXPECT_TRUE(labels.insert(method.label).second) << method.label;
    kinds.push_back(method.kind);
    EXPECT_EQ(method.render.max_bounces, 7) << method.label;
    EXPECT_EQ(method.rays_per_px > 0, method.render.method == Method::kSampled) << method.label;
    EXPECT_EQ(method.rays_per_px > 0, method.direction_mrad == 0.0) << method.label;
    if (method.rays_per_px > 0) {
      const int per_axis = method.render.rays_per_axis;
      EXPECT_EQ(method.rays_per_px, per_axis * per_axis) << method.label;
    } else {
      const double rad = method.render.max_direction_error_rad;
      EXPECT_NEAR(method.direction_mrad, 1e3 * rad, 1e-12) << method.label;
    }
  }
  EXPECT_THAT(kinds, ElementsAre(0, 0, 0, 0, 0, 1, 1, 1, 2, 3, 3));
}

TEST(ComparedMethods, AreNoneWherePathsAreTheOnlyWay) {
  EXPECT_THAT(compared_methods(path_scene()), IsEmpty());
}

TEST(ComparedMethods, AreThoseOfASceneWithANoiselessReference) {
  SceneSettings blurred;
  blurred.material.type = MaterialSettings::Type::kConductor;
  blurred.material.alpha = {0.05};
  blurred.render.method = Method::kBlurred;
  SceneSettings direct = path_scene();
  direct.render.method = Method::kDirect;
  for (const SceneSettings& scene : {path_scene(), blurred, direct}) {
    EXPECT_FALSE(has_noiseless_reference(scene));
    EXPECT_THAT(compared_methods(scene), IsEmpty());
    EXPECT_THAT(compared_paths(scene), Not(IsEmpty()));
  }
  for (const Method method : {Method::kAuto, Method::kSampled, Method::kClosed}) {
    EXPECT_TRUE(has_noiseless_reference(mirror_scene(method)));
    EXPECT_THAT(compared_methods(mirror_scene(method)), Not(IsEmpty()));
    EXPECT_THAT(compared_paths(mirror_scene(method)), IsEmpty());
  }
}

TEST(ComparedPaths, EndWithBlurredReflectionsWhereTheyMayRenderTheScene) {
  SceneSettings scene;
  scene.material.type = MaterialSettings::Type::kConductor;
  scene.material.alpha = {0.05};
  const auto labels_of = [](const SceneSettings& of) {
    std::vector<std::string> labels;
    for (const ComparedMethod& method : compared_paths(of)) {
      if (!method.is_noisy) {
        EXPECT_EQ(method.render.method, Method::kBlurred);
        labels.push_back(method.label + (method.is_current ? " *" : ""));
      }
    }
    return labels;
  };
  EXPECT_THAT(labels_of(scene),
              ElementsAre("blurred, 1 ray", "blurred, 4 rays", "blurred, 16 rays"));
  scene.render.method = Method::kBlurred;
  EXPECT_THAT(compared_methods(scene), IsEmpty());
  EXPECT_THAT(labels_of(scene),
              ElementsAre("blurred, 1 ray", "blurred, 4 rays *", "blurred, 16 rays"));
  EXPECT_TRUE(needs_paths(independent_paths(scene, 16, 0))) << "what they are compared with";
  scene.render.method = Method::kAuto;
  scene.material.alpha = {0.3};
  EXPECT_THAT(labels_of(scene), IsEmpty());
}

TEST(ComparedPaths, EndWithDirectSumsWhereTheyMayRenderTheScene) {
  SceneSettings scene;
  scene.has_tunnel = false;
  scene.lights = {{.name = "ring", .settings = RingSettings{}}};
  scene.material.type = MaterialSettings::Type::kConductor;
  scene.material.alpha = {0.2};
  const auto labels_of = [](const SceneSettings& of) {
    std::vector<std::string> labels;
    for (const ComparedMethod& method : compared_paths(of)) {
      EXPECT_TRUE(method.has_film) << method.label;
      if (!method.is_noisy) {
        EXPECT_EQ(method.render.method, Method::kDirect);
        labels.push_back(method.label + (method.is_current ? " *" : ""));
      }
    }
    return labels;
  };
  EXPECT_THAT(labels_of(scene),
              ElementsAre("direct sum, 1 ray", "direct sum, 4 rays", "direct sum, 16 rays"));
  scene.render.method = Method::kDirect;
  EXPECT_THAT(labels_of(scene),
              ElementsAre("direct sum, 1 ray", "direct sum, 4 rays *", "direct sum, 16 rays"));
  EXPECT_FALSE(is_direct(independent_paths(scene, 16, 0))) << "what they are compared with";
  scene.lights.push_back({.name = "sky", .settings = EnvironmentSettings{}});
  scene.render.method = Method::kAuto;
  EXPECT_THAT(labels_of(scene), IsEmpty());
}

}  // namespace
}  // namespace glint
