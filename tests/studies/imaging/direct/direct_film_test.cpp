// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/direct/direct_film.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/imaging/path_picture.h"
#include "studies/imaging/scene_picture.h"
#include "studies/imaging/scene_store.h"
#include "tests/studies/imaging/direct/lamp_scene.h"

namespace glint::lamp_test {
namespace {

// Exposure 2, gain 1.5, brightest factor 3: radiance 1 of that group is 9 of full scale; 2^4 is the
// next power of 2. In dim pictures nothing is summed less exactly.
TEST(BrightnessOctave, IsThatOfTheBrightestGroupInTheSensorsPicture) {
  const SensorSettings sensor = {.exposure = 2.0, .gain = 1.5};
  const std::vector<std::vector<Colour>> frames = {{Colour(0.5, 0.5, 0.5), Colour(1.0, 3.0, 1.0)},
                                                   {Colour(0.0, 0.0, 0.0)}};
  EXPECT_EQ(brightness_octave(sensor, frames), 4);
  EXPECT_EQ(brightness_octave({.exposure = 0.01}, frames), 0);
  EXPECT_EQ(brightness_octave(sensor, {}), 0);
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(brightness_octave({.exposure = kInfinite}, frames), 30);
}

// 5e-4 of full scale at 2 x 2 rays; at four times the brightness the radiance is 1.25e-4, at 4 x 4
// rays a quarter of it.
TEST(DirectSettings, AreFinerByBrightnessAndRays) {
  const RenderSettings usual;
  EXPECT_EQ(usual.rays_per_axis, 2);
  EXPECT_DOUBLE_EQ(direct_settings(usual, 0).tolerance, 5e-4);
  EXPECT_DOUBLE_EQ(direct_settings(usual, 2).tolerance, 1.25e-4);
  EXPECT_DOUBLE_EQ(direct_settings({.rays_per_axis = 4}, 2).tolerance, 3.125e-5);
  EXPECT_DOUBLE_EQ(direct_settings({.rays_per_axis = 1}, 0).tolerance, 2e-3);
  EXPECT_DOUBLE_EQ(direct_settings(usual, 1).interpolated, 5e-4);
  EXPECT_EQ(direct_settings({.rays_per_axis = 4}, 0).max_rays_per_axis, 16);
}

TEST(FrameFactors, AreRefusedForAPowerOfALightWithoutFlux) {
  const SceneSettings scene =
      lamp_scene("[lighting.bar]\nlength_mm = 20\nwidth_mm = 10\npower_w = [1]\n");
  const Colour dark = Colour::Zero();
  try {
    frame_factors(scene, {&dark, 1});
    FAIL() << "nothing was refused";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), ::testing::StartsWith("lighting.bar.power_w: needs a light that"));
  }
}

TEST(DirectPictures, AreKeptForPowersOfOneOctave) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const auto picture_at = [&](double radiance) {
    SceneSettings scene = lamp_scene(kRing);
    std::get<RingSettings>(scene.lights[0].settings).emission.radiance = {radiance};
    return store.picture(scene);
  };
  const auto first = picture_at(2.2);
  EXPECT_EQ(first, picture_at(3.9));
  EXPECT_NE(first, picture_at(4.1));
  EXPECT_FALSE(first->has_noise);
  EXPECT_TRUE(first->batches.empty());
}

TEST(DirectPictures, AreOthersThanThoseOfPaths) {
  const auto key_of = [](const SceneSettings& scene) {
    return picture_key(scene, scene.viewpoint());
  };
  const SceneSettings scene = lamp_scene(kRing);
  EXPECT_NE(key_of(scene), key_of(by_paths(scene)));
  SceneSettings finer = scene;
  finer.render.rays_per_axis = 4;
  EXPECT_NE(key_of(scene), key_of(finer));
  EXPECT_EQ(key_of(by_paths(scene)), key_of(by_paths(finer))) << "paths have no such rays";
}

// A lamp of 20 mm x 10 mm, 1 W: radiance 1 sends pi x 2e-4 W, so the factor is 1591.5 and the
// octave 11.
TEST(DirectPictures, OfLampsWithAPowerAreAsExact) {
  const auto key_at = [](const std::string& emission) {
    const SceneSettings scene =
        lamp_scene("[lighting.bar]\nlength_mm = 20\nwidth_mm = 10\n" + emission);
    return picture_key(scene, scene.viewpoint());
  };
  EXPECT_EQ(key_at("power_w = [1]\n"), key_at("radiance = [1591.5]\n"));
  EXPECT_NE(key_at("power_w = [1]\n"), key_at("radiance = [1]\n"));
}

/// Exposed to 0.9, with pixels enough that a ninth of them tell how bright it is.
SceneSettings fine_scene(const std::string& light) {
  SceneSettings scene = lamp_scene(light);
  scene.expose_to = 0.9;
  scene.camera.width_px *= 4;
  scene.camera.height_px *= 4;
  scene.camera.object_pixel_mm /= 4.0;
  return scene;
}

// The exposure is not known before the light is, and how exactly light is summed follows from the
// exposure. Steel that reflects less than the lamp's radiance shows at 0.9 wants an exposure above
// 1, so that sums for exposure 1 would not be exact enough.
TEST(DirectPictures, AtEqualExposureAreSummedOnce) {
  ThreadPool pool(2);
  for (const std::string& light : {kRing, kDome, kBar}) {
    SCOPED_TRACE(light);
    SceneStore store(pool);
    SceneSettings scene = fine_scene(light);
    const SceneSettings exposed = with_equal_exposure(store, scene);
    EXPECT_GT(exposed.sensor.exposure, 1.0);
    EXPECT_EQ(store.num_rendered(), 1);
    const auto picture = picture_of(store, scene, {.has_flawless = false});
    EXPECT_EQ(store.num_rendered(), 1) << "the exposure was found in the same picture";
    EXPECT_EQ(picture->scene().sensor.exposure, exposed.sensor.exposure);
  }
}

// As exact as if the exposure had been known: the octave follows from the exposure that is found.
TEST(DirectPictures, AtEqualExposureAreAsExactAsAtThatExposure) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = lamp_scene(kRing);
  scene.expose_to = 0.9;
  const SceneSettings exposed = with_equal_exposure(store, scene);
  SceneStore fresh(pool);
  const ImageF aspect = picture_of(store, scene)->mean({}).aspect;
  EXPECT_EQ(aspect.values(), picture_of(fresh, exposed)->mean({}).aspect.values());
}

TEST(DirectFilm, IsSeenOnceInTheMaking) {
  ThreadPool pool(2);
  SceneStore store(pool);
  int passes = 0;
  const auto picture = store.picture(lamp_scene(kRing), [&](const PathProgress& progress) {
    ++passes;
    EXPECT_EQ(progress.tiles_left, 0);
    EXPECT_EQ(progress.sums->groups.size(), 1U);
    return true;
  });
  EXPECT_EQ(passes, 1);
  EXPECT_GT(picture->sums.counts.camera, 40 * 30 * 16);
}

}  // namespace
}  // namespace glint::lamp_test
