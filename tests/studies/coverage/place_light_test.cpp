// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/places/place_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/studies/coverage/coverage_scenes.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// A mirror plate, its top at z = 0, under a semicylinder of 100 mm radius and 120 mm length with a
/// slot of 20 mm; the camera at 400 mm above.
SceneSettings mirror_scene() {
  SceneSettings scene = bare_scene();
  scene.part.shape = PartSettings::Shape::kPlate;
  scene.part.length_mm = 100.0;
  scene.part.width_mm = 40.0;
  scene.part.thickness_mm = 2.0;
  scene.part.position_mm = {0.0, 0.0, -1.0};
  scene.has_tunnel = true;
  scene.tunnel.radius_mm = 100.0;
  scene.tunnel.length_mm = 120.0;
  scene.tunnel.slot_mm = 20.0;
  scene.tunnel.blocks_view = false;
  scene.scan.positions = 8;  // of 16 / 8 = 2 mm
  scene.camera.working_distance_mm = 400.0;
  scene.viewpoints = {viewpoint_at({0.0, 0.0, 400.0})};
  return scene;
}

std::vector<PlaceLight> light_of(const SceneSettings& scene, const std::vector<SeenPlace>& places) {
  ThreadPool pool(2);
  SceneStore store(pool);
  return light_of_places(store, scene, scene.viewpoint(), places, 64);
}

SeenPlace place_at(const SceneSettings& scene, const Vector3d& point_mm) {
  const PinholeCamera camera(intrinsics_of(scene));
  return {.point_mm = point_mm,
          .normal = Vector3d::UnitZ(),
          .pixel_px = *camera.project(camera_from_world(scene.viewpoint()) * point_mm)};
}

// A ray that the plate mirrors at (x, y, 0) is at (x, y) (1 + t / 400) when it is t above it. At
// the wall y^2 (1 + t / 400)^2 + t^2 = 100^2. From (x, 15) that is t = 98.2, factor 1.2455, y
// = 18.7, beyond the slot's 10; x meets the wall at 1.2455 x, between its ends while |1.2455 x - 2
// k| < 60.
//   x = 0:   always, 8 of 8 positions
//   x = -46: at -57.3; -57.3 - 2 k > -60 for k = 0 and 1: 2 of 8
//   x = -49: at -61.0: never
//   x = 49:  at 61.0; 61.0 - 2 k < 60 for k = 1 to 7: 7 of 8
// From (0, 0) it goes out through the slot.
TEST(LightOfPlaces, OfAMirrorTellsAtHowManyPositionsItShowsTheWall) {
  const SceneSettings scene = mirror_scene();
  const auto lights = light_of(scene,
                               {place_at(scene, {0.0, 15.0, 0.0}),
                                place_at(scene, {-46.0, 15.0, 0.0}),
                                place_at(scene, {-49.0, 15.0, 0.0}),
                                place_at(scene, {49.0, 15.0, 0.0}),
                                place_at(scene, {0.0, 0.0, 0.0})});
  EXPECT_EQ(lights[0].lit_share, 1.0);
  EXPECT_EQ(lights[1].lit_share, 0.25);
  EXPECT_EQ(lights[2].lit_share, 0.0);
  EXPECT_EQ(lights[3].lit_share, 0.875);
  EXPECT_EQ(lights[4].lit_share, 0.0);
}

// Half of 8 positions show a bright stripe of radiance 1, the others a dark one.
TEST(LightOfPlaces, OfAMirrorHasTheMeanOfTheStripes) {
  SceneSettings scene = mirror_scene();
  scene.sensor.exposure = 0.8;
  const auto lights = light_of(scene, {place_at(scene, {3.1, 15.0, 0.0})});
  EXPECT_NEAR(lights[0].mean, 0.4, 1e-6);
  EXPECT_EQ(lights[0].darkest, 0.0);
  EXPECT_FALSE(lights[0].is_hidden);
  scene.sensor.full_well_e = 10000.0;
  scene.sensor.dark_e = 500.0;
  const auto on_dark = light_of(scene, {place_at(scene, {3.1, 15.0, 0.0})});
  EXPECT_NEAR(on_dark[0].mean, 0.45, 1e-6);
  EXPECT_NEAR(on_dark[0].darkest, 0.05, 1e-12);
}

// The same rays of rough metal are spread over the wall beside the slot and beyond its ends: it is
// bright where a mirror would be dark, as the paths of a coarse picture say, whichever way imaging
// takes.
TEST(LightOfPlaces, OfRoughMetalUnderATunnelIsThatOfPaths) {
  SceneSettings scene = mirror_scene();
  scene.camera.width_px = 240;
  scene.camera.height_px = 240;
  scene.camera.object_pixel_mm = 0.5;
  scene.material.type = MaterialSettings::Type::kConductor;
  scene.material.roughness = 0.3;
  scene.render.method = RenderSettings::Method::kBlurred;
  const std::vector<SeenPlace> places = {place_at(scene, {0.0, 0.0, 0.0}),
                                         place_at(scene, {-49.0, 15.0, 0.0})};
  const auto blurred = light_of(scene, places);
  scene.render.method = RenderSettings::Method::kPaths;
  const auto traced = light_of(scene, places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(blurred[i].lit_share, 1.0);
    EXPECT_EQ(blurred[i].mean, traced[i].mean);
    EXPECT_GT(blurred[i].mean, 0.05);
  }
}

// The camera's sight line to (0, 15, 0) passes the wall's height, 99 mm, at y = 11.3: it goes
// through the slot of 24 mm but not through one of 20 mm.
TEST(LightOfPlaces, OfAMirrorIsHiddenByTheWallBesideTheSlot) {
  SceneSettings scene = mirror_scene();
  scene.tunnel.blocks_view = true;
  EXPECT_TRUE(light_of(scene, {place_at(scene, {0.0, 15.0, 0.0})})[0].is_hidden);
  scene.tunnel.slot_mm = 24.0;
  EXPECT_FALSE(light_of(scene, {place_at(scene, {0.0, 15.0, 0.0})})[0].is_hidden);
}

/// A rough plate of half reflectance under an even sky of radiance 1: 0.5 everywhere.
SceneSettings diffuse_scene() {
  SceneSettings scene = bare_scene();
  scene.part.shape = PartSettings::Shape::kPlate;
  scene.part.length_mm = 60.0;
  scene.part.width_mm = 40.0;
  scene.part.thickness_mm = 2.0;
  scene.material.type = MaterialSettings::Type::kDiffuse;
  scene.material.reflectance = {0.5};
  scene.camera.width_px = 200;
  scene.camera.height_px = 200;
  scene.camera.object_pixel_mm = 0.6;
  scene.lights = {{.name = "sky", .settings = EnvironmentSettings{}}};
  return scene;
}

TEST(LightOfPlaces, OfADiffusePlateUnderAnEvenSkyIsItsReflectance) {
  SceneSettings scene = diffuse_scene();
  scene.material.roughness = 0.0;
  scene.sensor.gain = 1.2;
  const auto lights =
      light_of(scene, {place_at(scene, {0.0, 0.0, 1.0}), place_at(scene, {29.9, 19.9, 1.0})});
  for (const PlaceLight& light : lights) {
    EXPECT_NEAR(light.mean, 0.6, 0.03);
    EXPECT_EQ(light.mean, light.darkest);
    EXPECT_EQ(light.lit_share, 1.0);
    EXPECT_FALSE(light.is_hidden);
  }
}

TEST(LightOfPlaces, IsHiddenByALightBeforeTheCamera) {
  SceneSettings scene = diffuse_scene();
  BarSettings bar;
  bar.placement.position_mm = {-20.0, 0.0, 150.0};
  bar.length_mm = 10.0;
  bar.width_mm = 100.0;
  scene.lights.push_back({.name = "bar", .settings = bar});
  // From 300 mm the bar, at half the height, hides what is twice as far aside: -50 to -30 mm.
  scene.part.length_mm = 110.0;
  const auto lights =
      light_of(scene, {place_at(scene, {-40.0, 0.0, 1.0}), place_at(scene, {-20.0, 0.0, 1.0})});
  EXPECT_TRUE(lights[0].is_hidden);
  EXPECT_FALSE(lights[1].is_hidden);
}

// Bright stripes at 1.5 times full scale are clipped, the frames between them are not.
TEST(CoverScene, OfAMirrorIsNotClippedWhereSomeFramesAreDark) {
  SceneSettings scene = mirror_scene();
  scene.tunnel.length_mm = 130.0;  // lights the whole part while it travels 14 mm
  scene.sensor.gain = 1.5;
  scene.coverage.points = 4000;
  const auto share_of = [&](CellState state) {
    return cover(scene).state_shares[static_cast<std::size_t>(state)];
  };
  EXPECT_EQ(share_of(CellState::kClipped), 0.0);
  EXPECT_GT(share_of(CellState::kInspected), 0.1);
  scene.tunnel.dark_reflectance = 0.0;
  scene.tunnel.duty = 0.999;
  scene.coverage.min_lit_share = 1.0;
  EXPECT_GT(share_of(CellState::kClipped), 0.1);
}

// Light at 0.9 of full scale is not clipped, on a dark signal of 0.1 it is.
TEST(CoverScene, OfALightOnADarkSignalIsClippedByTheirSum) {
  SceneSettings scene = diffuse_scene();
  scene.sensor.exposure = 1.8;
  scene.sensor.full_well_e = 10000.0;
  scene.coverage.points = 1000;
  scene.coverage.max_grey = 0.95;
  const auto clipped = [&] {
    return cover(scene).state_shares[static_cast<std::size_t>(CellState::kClipped)];
  };
  EXPECT_EQ(clipped(), 0.0);
  scene.sensor.dark_e = 1000.0;
  EXPECT_NEAR(clipped(), 2400.0 / 5200.0, 0.02);
}

TEST(CoverScene, TellsWhatIsDarkAndWhatIsClipped) {
  SceneSettings scene = diffuse_scene();
  scene.coverage.points = 1000;
  const double top = 2400.0 / 5200.0;
  const auto share_of = [&](CellState state) {
    return cover(scene).state_shares[static_cast<std::size_t>(state)];
  };
  EXPECT_NEAR(share_of(CellState::kInspected), top, 0.01);
  scene.coverage.min_grey = 0.7;
  EXPECT_NEAR(share_of(CellState::kDark), top, 0.01);
  scene.coverage = {.min_grey = 0.02, .max_grey = 0.3, .points = 1000};
  EXPECT_NEAR(share_of(CellState::kClipped), top, 0.01);
  scene.coverage.has_light = false;
  EXPECT_NEAR(share_of(CellState::kInspected), top, 0.01);
}

}  // namespace
}  // namespace glint
