// SPDX-License-Identifier: GPL-3.0-or-later
//
// render.method = "blurred": pictures and scores beside those of path tracing.
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/evaluation/evaluation.h"
#include "studies/imaging/line_camera.h"
#include "studies/imaging/scene_picture.h"
#include "tests/studies/imaging/blurred/satin_scene.h"

namespace glint::satin_test {
namespace {

using ::testing::HasSubstr;

struct Frames {
  std::vector<ImageF> grey;
  Mask region;
};

Frames frames_of(const SceneSettings& scene, int threads = 2) {
  ThreadPool pool(threads);
  SceneStore store(pool);
  const auto picture = picture_of(store, scene, {.has_flawless = false});
  Frames frames = {.grey = {}, .region = picture->traced()->region.mask};
  const auto keep = [&](int /*index*/, const ImageF& grey) { frames.grey.push_back(grey); };
  picture->mean({.watch = keep, .has_whole_frames = true});
  return frames;
}

Scores scores_of(const SceneSettings& scene, int threads = 2) {
  ThreadPool pool(threads);
  SceneStore store(pool);
  return evaluate(store, scene, {}, {}).scores;
}

/// Root of the mean product of the distances from two pictures whose noise is independent: that of
/// neither is left in it, on average.
double rms_beside(const Frames& frames, const Frames& a, const Frames& b, const Mask& where) {
  double product = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < frames.grey.size(); ++k) {
    for (std::size_t i = 0; i < where.size(); ++i) {
      if (where.values()[i] != 0) {
        const auto value = static_cast<double>(frames.grey[k].values()[i]);
        product += (value - static_cast<double>(a.grey[k].values()[i])) *
                   (value - static_cast<double>(b.grey[k].values()[i]));
        count += 1.0;
      }
    }
  }
  EXPECT_GT(count, 3000.0);
  return std::sqrt(std::max(0.0, product / count));
}

Frames path_frames(int seed) {
  SceneSettings scene = satin_scene("");
  scene.paths.seed = seed;
  EXPECT_TRUE(needs_paths(scene));
  return frames_of(scene);
}

TEST(BlurredPicture, IsThatOfPathTracing) {
  const Frames a = path_frames(1);
  const Frames b = path_frames(5000);
  const Frames blurred = frames_of(satin_scene());
  SceneSettings wider = satin_scene();
  wider.material.alpha = {0.06};
  const double rms = rms_beside(blurred, a, b, blurred.region);
  const double control = rms_beside(frames_of(wider), a, b, blurred.region);
  fmt::print("rms {:.4f} of full scale, control {:.4f}\n", rms, control);
  EXPECT_LT(rms, 0.002);
  EXPECT_GT(control, 0.004);
}

// Noise of paths is part of their scores: at most three of their standard errors and, as a bias, a
// few thousandths.
TEST(BlurredPicture, HasTheScoresOfPathTracing) {
  const auto noisy = [](SceneSettings scene) {
    scene.sensor.full_well_e = 10000.0;
    scene.sensor.blur_px = 0.7;
    return scene;
  };
  const Scores blurred = scores_of(noisy(satin_scene()));
  const Scores paths = scores_of(noisy(satin_scene("")));
  for (const auto& [name, allowed] : std::vector<std::pair<std::string, double>>{
           {"homogeneity.h_rms", 0.004}, {"homogeneity.mean", 0.002}}) {
    const double error = paths.at(name + ".error");
    fmt::print(
        "{}: {:.4f}, paths {:.4f} +- {:.4f}\n", name, blurred.at(name), paths.at(name), error);
    EXPECT_NEAR(blurred.at(name), paths.at(name), allowed + 3.0 * error) << name;
  }
  for (const char* name : {"defects.min_cnr", "defects.dent_1.change"}) {
    const double error = paths.at(std::string(name) + ".error");
    fmt::print(
        "{}: {:.4f}, paths {:.4f} +- {:.4f}\n", name, blurred.at(name), paths.at(name), error);
    EXPECT_NEAR(blurred.at(name), paths.at(name), 0.05 * paths.at(name) + 3.0 * error) << name;
  }
  EXPECT_FALSE(blurred.contains("homogeneity.h_rms.error")) << "it has no noise of its own";
}

TEST(BlurredPicture, ClipsAsTheSensorDoes) {
  SceneSettings scene = satin_scene();
  scene.sensor.exposure = 4.0;
  for (const ImageF& grey : frames_of(scene).grey) {
    for (const float value : grey.values()) {
      ASSERT_LE(value, 1.0F);
    }
  }
  EXPECT_GT(scores_of(scene).at("homogeneity.clipped_share"), 0.01);
}

/// Higher than the rows that one thread takes.
TEST(BlurredPicture, IsTheSameForAnyNumberOfThreads) {
  SceneSettings scene = satin_scene();
  scene.camera.width_px = 14;
  scene.camera.height_px = 300;
  scene.camera.object_pixel_mm = 0.05;
  scene.viewpoints = {default_viewpoint(scene.camera)};
  scene.defects.clear();
  scene.sensor.full_well_e = 10000.0;
  const Frames one = frames_of(scene, 1);
  for (const int threads : {2, 7}) {
    const Frames more = frames_of(scene, threads);
    for (std::size_t k = 0; k < one.grey.size(); ++k) {
      EXPECT_EQ(one.grey[k].values(), more.grey[k].values()) << threads << " threads";
    }
  }
}

TEST(BlurredPicture, ACandidateHasTheSameScoresEveryTime) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const Scores first = evaluate(store, satin_scene(), {}, {}).scores;
  SceneSettings other = satin_scene();
  other.tunnel.radius_mm = 90.0;
  other.material.alpha = {0.03};
  const Scores between = evaluate(store, other, {}, {}).scores;
  EXPECT_NE(first, between);
  EXPECT_EQ(first, evaluate(store, satin_scene(), {}, {}).scores);
  EXPECT_EQ(store.num_traced(), 1) << "light and metal leave the rays alone";
}

TEST(BlurredPicture, OfAnInspectionLineIsTheScoredOne) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = satin_scene();
  scene.sensor.full_well_e = 10000.0;
  const ImageF scored = picture_of(store, scene)->mean({}).aspect;
  SceneSettings flawless = scene;
  flawless.defects.clear();
  const auto line = line_camera_of(store, scene, store.trace(flawless));
  EXPECT_EQ(line->part(*store.build_defects(scene), scene.sensor).aspect.values(), scored.values());
  EXPECT_NE(line->flawless(scene.sensor).aspect.values(), scored.values());
  EXPECT_TRUE(line->expected().renderings.empty()) << "rendering has no noise";
}

TEST(BlurredPicture, RefusesStripesThatTheLobeDoesNotBlur) {
  SceneSettings scene = satin_scene();
  scene.material.alpha = {0.02};
  scene.tunnel.period_mm = 3000.0;
  scene.tunnel.length_mm = 12000.0;
  try {
    frames_of(scene);
    FAIL() << "more harmonics than there may be";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("render.method"));
  }
}

TEST(BlurredPicture, OfOnePixelIsThere) {
  SceneSettings scene = satin_scene();
  scene.camera.width_px = scene.camera.height_px = 1;
  scene.camera.object_pixel_mm = 1.0;
  scene.viewpoints = {default_viewpoint(scene.camera)};
  scene.defects.clear();
  scene.metrics.erosion_px = 0;
  const Frames frames = frames_of(scene);
  ASSERT_EQ(frames.grey.size(), 6U);
  EXPECT_TRUE(std::isfinite(frames.grey[0].values()[0]));
}

}  // namespace
}  // namespace glint::satin_test
