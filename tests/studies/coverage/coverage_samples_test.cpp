// SPDX-License-Identifier: GPL-3.0-or-later
//
// Coverage of parts without a closed form against a hundred times as many points.
#include <gtest/gtest.h>

#include "tests/studies/coverage/coverage_scenes.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

/// C1 of every view alone and of all together, from as many points as scenes have and from a
/// hundred times as many.
void expect_same_with_more_points(SceneSettings scene) {
  const SceneCoverage few = cover(scene);
  scene.coverage.points *= 100;
  scene.coverage.seed += 1;
  const SceneCoverage many = cover(scene);
  ASSERT_GT(many.cells.size(), 20 * few.cells.size());
  EXPECT_NEAR(few.coverage.c1(), many.coverage.c1(), 0.002);
  for (std::size_t i = 0; i < few.coverage.views.size(); ++i) {
    EXPECT_NEAR(few.coverage.views[i].sees, many.coverage.views[i].sees, 0.002) << "view " << i;
  }
}

TEST(CoverScene, OfAGearIsThatOfAHundredTimesThePoints) {
  expect_same_with_more_points(gear_scene());
}

TEST(CoverScene, OfACupIsThatOfAHundredTimesThePoints) {
  const TemporaryFolder folder;
  write_cup(folder / "cup.ply");
  SceneSettings scene = cup_scene(folder / "cup.ply");
  scene.viewpoints = {viewpoint_at({60.0, 20.0, 150.0}), viewpoint_at({-150.0, 0.0, 50.0})};
  scene.camera.object_pixel_mm = 0.2;
  expect_same_with_more_points(scene);
}

}  // namespace
}  // namespace glint
