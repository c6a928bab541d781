// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/illuminated_place.h"

#include <gtest/gtest.h>

#include "studies/evaluation/evaluation.h"

namespace glint {
namespace {

/// A plate that lies flat, 60 x 40 mm, under a semicylinder of 100 mm, camera at 400 mm.
///
/// The camera's own place is mirrored at its middle. A ray that meets the plate at y rises with
/// slope y / 400 and is at y (1 + 100 / 400) = 1.25 y when it is at the tunnel's top: it passes the
/// slot, 30 mm wide, where |y| < 15 / 1.25 = 12 mm, and meets the wall from there to the rim.
SceneSettings plate_scene() {
  SceneSettings scene;
  scene.part.shape = PartSettings::Shape::kPlate;
  scene.part.length_mm = 60.0;
  scene.part.width_mm = 40.0;
  scene.camera.width_px = 320;
  scene.camera.height_px = 220;
  scene.camera.object_pixel_mm = 0.2;
  scene.camera.working_distance_mm = 400.0;
  scene.viewpoint() = default_viewpoint(scene.camera);
  scene.tunnel.radius_mm = 100.0;
  scene.tunnel.slot_mm = 30.0;
  return scene;
}

TEST(IlluminatedPlaces, LiesBesideWhatMirrorsTheSlotAndNearTheMiddle) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const auto place = illuminated_places(store, plate_scene(), 1.0);
  ASSERT_EQ(place.places_mm.size(), 1U);
  EXPECT_NEAR(place.places_mm.front().x(), 0.0, 1.0);
  // 12 mm and the margin of 1 mm; the wall is round and the plate's top is 1.5 mm up.
  EXPECT_GT(std::abs(place.places_mm.front().y()), 12.0);
  EXPECT_LT(std::abs(place.places_mm.front().y()), 14.5);
  // 40 mm - 2 x 12 mm of 40 mm are lit.
  EXPECT_NEAR(place.lit_share, 0.4, 0.03);
}

TEST(IlluminatedPlaces, IsWhereADentShows) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = plate_scene();
  const auto place = illuminated_places(store, scene, 2.0);
  ASSERT_EQ(place.places_mm.size(), 1U);
  DefectGroup dent{.height_mm = 8e-3, .diameter_mm = 1.0};
  dent.x_mm = {place.places_mm.front().x()};
  dent.y_mm = {place.places_mm.front().y()};
  scene.defects = {{"dent", dent}};
  EXPECT_GT(evaluate(store, scene).scores.at("defects.min_change"), 0.2);
  scene.defects.front().second.y_mm = {0.0};  // in the band that mirrors the slot
  EXPECT_LT(evaluate(store, scene).scores.at("defects.min_change"), 0.01);
}

TEST(IlluminatedPlaces, SeveralLieTwoMarginsApartTheNearestToTheMiddleFirst) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const auto found = illuminated_places(store, plate_scene(), 1.5, 8).places_mm;
  ASSERT_EQ(found.size(), 8U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_GT(std::abs(found[i].y()), 12.0) << i;
    EXPECT_GE(found[i].norm(), found.front().norm() - 0.5) << i;
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_GE((found[i] - found[k]).norm(), 3.0);
    }
  }
}

TEST(IlluminatedPlaces, IsNoneWhereNoLightArrives) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = plate_scene();
  scene.tunnel.slot_mm = 80.0;  // dark up to 40 / 1.25 = 32 mm, beyond the plate's 20 mm
  EXPECT_TRUE(illuminated_places(store, scene, 1.0).places_mm.empty());
}

TEST(IlluminatedPlaces, IsTheSameForAnyNumberOfThreads) {
  ThreadPool one(1);
  ThreadPool two(2);
  SceneStore store_one(one);
  SceneStore store_two(two);
  const auto a = illuminated_places(store_one, plate_scene(), 1.0);
  const auto b = illuminated_places(store_two, plate_scene(), 1.0);
  ASSERT_FALSE(a.places_mm.empty());
  EXPECT_EQ(a.places_mm, b.places_mm);
  EXPECT_EQ(a.lit_share, b.lit_share);
}

}  // namespace
}  // namespace glint
