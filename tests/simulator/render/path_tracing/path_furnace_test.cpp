// SPDX-License-Identifier: GPL-3.0-or-later
//
// Under a sky that is equally bright everywhere, a surface that absorbs nothing cannot be seen.
#include <gtest/gtest.h>

#include "tests/simulator/render/path_tracing/path_bench.h"

namespace glint::path_test {
namespace {

double brightness_of_part(const PartSettings& part,
                          const MaterialSettings& material,
                          const CameraSettings& camera,
                          int samples) {
  const PathBench bench(part, material, {white_sky()}, camera);
  return mean_of(bench.picture({.samples = samples, .max_reflections = 64, .channels = 1}));
}

TEST(Furnace, WhiteSurfacesOfOneWidthVanish) {
  const CameraSettings camera = small_camera();
  for (const MaterialSettings& material : {white_mirror(),
                                           matt(1.0),
                                           matt(1.0, 0.7),
                                           white_metal({0.05, 0.05}),
                                           white_metal({0.3, 0.3}),
                                           white_metal({1.0, 1.0})}) {
    EXPECT_NEAR(brightness_of_part(flat_plate(), material, camera, 256), 1.0, 1e-3);
  }
}

TEST(Furnace, WhiteBallVanishes) {
  const CameraSettings camera = small_camera(1.0, 24, 24);
  EXPECT_NEAR(brightness_of_part(small_ball(), matt(1.0), camera, 256), 1.0, 1e-3);
  EXPECT_NEAR(brightness_of_part(small_ball(), white_metal({0.2, 0.2}), camera, 256), 1.0, 1e-3);
}

TEST(Furnace, BrushedMetalVanishes) {
  const CameraSettings camera = small_camera();
  EXPECT_NEAR(brightness_of_part(flat_plate(), white_metal({0.3, 0.1}), camera, 256), 1.0, 5e-3);
  EXPECT_NEAR(
      brightness_of_part(flat_plate(), white_metal({0.1028, 0.0380}), camera, 256), 1.0, 5e-3);
}

TEST(Furnace, LightIsFoundBetweenTheTeethOfAGear) {
  PartSettings gear = {.shape = PartSettings::Shape::kSpurGear};
  gear.rotation_rad = {0.3, 1.2, 0.0};
  EXPECT_NEAR(brightness_of_part(gear, matt(1.0), small_camera(3.0), 64), 1.0, 1e-3);
  EXPECT_NEAR(brightness_of_part(gear, white_metal({0.3, 0.3}), small_camera(3.0), 64), 1.0, 2e-3);
}

TEST(Furnace, MetalThatLosesLightBetweenItsFacetsIsSeen) {
  MaterialSettings lossy = white_metal({1.0, 1.0});
  lossy.multiple_reflections = false;
  EXPECT_LT(brightness_of_part(flat_plate(), lossy, small_camera(), 64), 0.95);
}

TEST(Furnace, GreyPlateUnderASkyHasItsReflectance) {
  EXPECT_NEAR(brightness_of_part(flat_plate(), matt(0.4), small_camera(), 256), 0.4, 4e-4);
}

TEST(Dome, MattPlateInItsMiddleSeesAllButTheOpening) {
  // The opening of radius 15 in a dome of radius 100 hides sin^2 = 0.0225 of the irradiance.
  DomeSettings dome;
  dome.radius_mm = 100.0;
  dome.opening_mm = 30.0;
  dome.placement.position_mm = {0.0, 0.0, 1.0};
  const PathBench bench(
      flat_plate(), matt(0.8), {{.name = "dome", .settings = dome}}, small_camera(0.05, 8, 8));
  EXPECT_NEAR(mean_of(bench.picture({.samples = 256})), 0.8 * (1.0 - 0.0225), 8e-4);
}

}  // namespace
}  // namespace glint::path_test
