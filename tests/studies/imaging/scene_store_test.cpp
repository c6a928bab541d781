// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>

#include <gtest/gtest.h>

#include "simulator/render/wall/occluded_pixels.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/scene_store.h"

namespace glint {
namespace {

SceneSettings stored_scene() {
  SceneSettings scene;
  scene.part.length_mm = 60.0;
  scene.part.width_mm = 30.0;
  scene.part.radius_along_mm = 300.0;
  scene.part.radius_across_mm = 40.0;
  scene.camera.width_px = 160;
  scene.camera.height_px = 80;
  scene.camera.object_pixel_mm = 0.4;
  scene.camera.working_distance_mm = 300.0;
  scene.viewpoint() = default_viewpoint(scene.camera);
  scene.tunnel.radius_mm = 120.0;
  return scene;
}

TEST(SceneStore, IntersectsTheWallAgainOnlyWhenItIsAnotherOne) {
  ThreadPool pool(1);
  SceneStore store(pool);
  SceneSettings scene = stored_scene();
  const auto traced = store.trace(scene);
  const auto intersect = [&] {
    return store.intersect(traced, traced->corners, Tunnel(scene.tunnel));
  };
  intersect();
  scene.tunnel.period_mm = 9.0;
  const auto second = intersect();  // kept from now on
  scene.tunnel.duty = 0.4;
  scene.tunnel.offset_mm = 1.0;
  scene.tunnel.dark_reflectance = 0.1;
  EXPECT_EQ(intersect(), second);
  EXPECT_EQ(store.num_intersected(), 2);
  scene.tunnel.slot_mm += 1.0;
  EXPECT_NE(intersect(), second);
  EXPECT_EQ(store.num_intersected(), 3);
}

TEST(SceneStore, DoesNotKeepWallsThatAreAskedForOnce) {
  ThreadPool pool(1);
  SceneStore store(pool);
  SceneSettings scene = stored_scene();
  const auto traced = store.trace(scene);
  const std::size_t before = store.kept_bytes();
  for (int i = 0; i < 20; ++i) {
    scene.tunnel.radius_mm += 1.0;
    store.intersect(traced, traced->corners, Tunnel(scene.tunnel));
  }
  EXPECT_EQ(store.kept_bytes(), before);
  EXPECT_EQ(store.num_intersected(), 20);
}

// Scenes and walls share the limit; the last scene stays whatever its size.
TEST(SceneStore, KeepsNoMoreThanItsLimit) {
  ThreadPool pool(1);
  SceneSettings scene = stored_scene();
  std::size_t one_scene = 0;
  {
    SceneStore store(pool);
    one_scene = bytes_of(*store.trace(scene));
  }
  const std::size_t maximum = 5 * one_scene;
  SceneStore store(pool, maximum);
  for (int i = 0; i < 6; ++i) {
    scene.camera.object_pixel_mm += 0.001;
    const auto traced = store.trace(scene);
    for (int j = 0; j < 40; ++j) {
      scene.tunnel.radius_mm = 120.0 + j / 2;  // each twice
      store.intersect(traced, traced->corners, Tunnel(scene.tunnel));
    }
    EXPECT_LE(store.kept_bytes(), maximum) << i;
    EXPECT_GT(store.kept_bytes(), one_scene) << i;
  }
  SceneStore tiny(pool, 1);
  EXPECT_EQ(tiny.trace(scene), tiny.trace(scene));
  EXPECT_EQ(tiny.num_traced(), 1);
}

// Defects that move: the first two scenes tell that the camera stays, then only their surroundings
// are traced, with the same bytes.
TEST(SceneStore, TracesOnlyAroundDefectsThatChange) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = stored_scene();
  scene.defects = {{"dent", {.x_mm = {0.0}, .y_mm = {0.0}, .height_mm = -4e-3}}};
  store.trace(scene);
  EXPECT_EQ(store.num_retraced(), 0);
  for (const double x_mm : {1.0, 2.0}) {
    scene.defects[0].second.x_mm = {x_mm};
    const auto retraced = store.trace(scene);
    SceneStore fresh(pool);
    const auto traced = fresh.trace(scene);
    EXPECT_EQ(retraced->corners.corners.direction_x, traced->corners.corners.direction_x);
    EXPECT_EQ(retraced->corners.coverage, traced->corners.coverage);
    ASSERT_EQ(retraced->corners.refined.size(), traced->corners.refined.size());
    for (std::size_t g = 0; g < traced->corners.refined.size(); ++g) {
      EXPECT_EQ(retraced->corners.refined[g].pixels, traced->corners.refined[g].pixels);
      EXPECT_EQ(retraced->corners.refined[g].rays.direction_y,
                traced->corners.refined[g].rays.direction_y);
    }
    EXPECT_EQ(retraced->counts().part, traced->counts().part);
  }
  EXPECT_EQ(store.num_traced(), 3);
  EXPECT_EQ(store.num_retraced(), 2);
  // Rays too large to be kept are not made again for each set of defects.
  SceneStore tiny(pool, 1);
  for (const double x_mm : {0.0, 1.0, 2.0, 3.0}) {
    scene.defects[0].second.x_mm = {x_mm};
    tiny.trace(scene);
  }
  EXPECT_EQ(tiny.num_traced(), 4);
  EXPECT_EQ(tiny.num_retraced(), 1);
}

TEST(SceneStore, TracesAgainForEveryTableThatTracingDependsOn) {
  ThreadPool pool(1);
  SceneStore store(pool);
  SceneSettings scene = stored_scene();
  store.trace(scene);
  scene.sensor.gain = 2.0;
  scene.scan.positions = 12;
  scene.tunnel.period_mm = 5.0;
  store.trace(scene);
  EXPECT_EQ(store.num_traced(), 1);
  scene.part.radius_across_mm += 1.0;
  store.trace(scene);
  scene.camera.width_px += 2;
  store.trace(scene);
  scene.viewpoint().position_mm[0] += 1.0;
  store.trace(scene);
  scene.render.reflectance = 0.9;
  store.trace(scene);
  scene.metrics.lit_threshold += 0.01;
  store.trace(scene);
  scene.defects = {{"dent", {.x_mm = {1.0}, .y_mm = {2.0}, .height_mm = 4e-3}}};
  store.trace(scene);
  scene.defects[0].first = "pit";
  store.trace(scene);
  EXPECT_EQ(store.num_traced(), 8);
}

SceneSettings imprinted_scene() {
  SceneSettings scene = stored_scene();
  scene.defects = {{"dents",
                    {.realisation = Realisation::kImprinted,
                     .count = 3.0,
                     .region = {.facing_rad = 0.5},
                     .edge_distance_mm = 5.0,
                     .height_mm = 0.1,
                     .diameter_mm = {1.0, 2.0}}}};
  return scene;
}

TEST(SceneStore, ImprintsAPartOnceForAllLightingsAndCameras) {
  ThreadPool pool(1);
  SceneStore store(pool);
  SceneSettings scene = imprinted_scene();
  const auto first = store.trace(scene);
  EXPECT_NE(first->part->built, first->part->clean);
  EXPECT_EQ(first->views.size(), 3U);
  scene.tunnel.radius_mm += 5.0;
  scene.viewpoint().position_mm[0] += 1.0;
  EXPECT_EQ(store.trace(scene)->part, first->part);
  EXPECT_EQ(store.num_defects_made(), 1);
  scene.imprint.seed = 2;
  const auto other = store.trace(scene);
  EXPECT_NE(other->part, first->part);
  EXPECT_NE(other->part->made.outlines[0].centre_mm, first->part->made.outlines[0].centre_mm);
  EXPECT_EQ(store.num_defects_made(), 2);
  scene.defects[0].second.height_mm = 0.12;
  store.trace(scene);
  EXPECT_EQ(store.num_defects_made(), 3);
}

// Deep imprints show in the picture, and only at their places.
TEST(SceneStore, ImprintedDefectsAreSeenAndScored) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const Evaluation evaluation = evaluate(store, imprinted_scene());
  EXPECT_EQ(evaluation.scores.at("defects.made"), 3.0);
  EXPECT_NEAR(evaluation.scores.at("defects.mean_depth_um"), 100.0, 1e-9);
  EXPECT_GT(evaluation.scores.at("defects.removed_volume_mm3"), 0.1);
  EXPECT_GT(evaluation.scores.at("defects.min_change"), 0.1);
}

// The same candidate with the same seed sees the same defects whatever happened before.
TEST(SceneStore, ImprintedScenesScoreTheSameAgain) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const Scores first = evaluate(store, imprinted_scene()).scores;
  SceneSettings other = imprinted_scene();
  other.imprint.seed = 9;
  evaluate(store, other);
  SceneStore fresh(pool);
  EXPECT_EQ(evaluate(store, imprinted_scene()).scores, first);
  EXPECT_EQ(evaluate(fresh, imprinted_scene()).scores, first);
}

// The gallery's own designs: tiles find every hidden pixel.
TEST(OccludedPixels, AreFoundByTilesInTheGallery) {
  const std::filesystem::path gallery =
      std::filesystem::path(GLINT_SOURCE_DIR) / "studies" / "gallery";
  ThreadPool pool(2);
  SceneStore store(pool);
  int scenes = 0;
  for (const auto& folder : std::filesystem::directory_iterator(gallery)) {
    if (!std::filesystem::exists(folder.path() / "study.toml")) {
      continue;  // a scene that is imprinted, not scanned
    }
    const Study study = load_study((folder.path() / "study.toml").string(), {});
    std::vector<SceneSettings> designs = {study.scene};
    for (const auto& prototype : study.prototypes) {
      designs.push_back(scene_with(study, prototype.overrides));
    }
    for (const SceneSettings& scene : designs) {
      const auto traced = store.trace(scene);
      const Tunnel tunnel(scene.tunnel);
      EXPECT_EQ(occluded_pixels(traced->seen(), tunnel, traced->camera_in_world_mm),
                occluded_pixels_one_by_one(traced->seen(), tunnel, traced->camera_in_world_mm))
          << folder.path() << ", design " << scenes;
      ++scenes;
    }
  }
  EXPECT_GT(scenes, 4);
}

}  // namespace
}  // namespace glint
