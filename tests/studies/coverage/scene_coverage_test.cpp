// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/coverage/scene_coverage.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/studies/coverage/coverage_scenes.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A plate of 60 x 40 x 2 mm, its top at z = 1.
SceneSettings plate() {
  SceneSettings scene = bare_scene();
  scene.part.shape = PartSettings::Shape::kPlate;
  scene.part.length_mm = 60.0;
  scene.part.width_mm = 40.0;
  scene.part.thickness_mm = 2.0;
  scene.coverage.points = 4000;
  return scene;
}

/// Share of the plate that its top is: 2400 of 2 (2400 + 120 + 80) mm2.
constexpr double kTop = 2400.0 / 5200.0;

TEST(SurfaceCells, HaveThePartsAreaAndOneLinkAnEdge) {
  ThreadPool pool(1);
  SceneStore store(pool);
  const auto part = store.build(gear_scene());
  const SurfaceCells cells = surface_cells(part->part, 5000, 1);
  const double area_mm2 = std::accumulate(cells.areas_mm2.begin(), cells.areas_mm2.end(), 0.0);
  EXPECT_NEAR(area_mm2, surface_area_mm2(part->part.mesh), 1e-9 * area_mm2);
  EXPECT_EQ(2 * cells.links.size(), 3 * cells.size());  // a closed surface
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Eigen::Vector3d normal = face_normal(cells.mesh, i);
    EXPECT_NEAR(normal.dot(cells.points_mm[i] - cells.mesh.vertex(i, 0)), 0.0, 1e-9);
    EXPECT_GT(normal.dot(cells.normals[i]), 0.9);
  }
}

TEST(SurfaceCells, AreAboutAsManyAsAskedFor) {
  ThreadPool pool(1);
  SceneStore store(pool);
  const auto part = store.build(plate());
  for (const int count : {1000, 10000, 100000}) {
    const SurfaceCells cells = surface_cells(part->part, count, 1);
    EXPECT_GT(cells.size(), static_cast<std::size_t>(count / 2));
    EXPECT_LT(cells.size(), static_cast<std::size_t>(count * 3));
  }
}

TEST(CoverScene, OfAPlateFromAboveIsItsTop) {
  const SceneCoverage covered = cover(plate());
  EXPECT_NEAR(covered.coverage.c1(), kTop, 1e-9);
  EXPECT_NEAR(covered.gap.area_mm2, 5200.0 * (1.0 - kTop), 1e-6);
  EXPECT_EQ(covered.gap.state, CellState::kUnseen);
  EXPECT_FALSE(covered.has_light);
}

// The picture is 120 mm wide; with a camera of a quarter of the width 30 mm of 60 are in it.
TEST(CoverScene, EndsWhereThePictureDoes) {
  SceneSettings scene = plate();
  scene.camera.width_px = 300;
  scene.coverage.points = 20000;
  // At z = 1 the picture is 30 (299 / 300) mm wide.
  EXPECT_NEAR(cover(scene).coverage.c1(), kTop * 0.5 * 299.0 / 300.0, 0.002);
}

// A pixel covers 0.1 mm at 300 mm, 0.0997 mm on the plate's top.
TEST(CoverScene, LeavesOutWhatIsTooCoarse) {
  SceneSettings scene = plate();
  scene.coverage.max_pixel_mm = 0.1005;
  const SceneCoverage fine = cover(scene);
  const auto [smallest, largest] =
      std::ranges::minmax_element(fine.of_cell, {}, [](const CellCoverage& cell) {
        return cell.views > 0 ? cell.pixel_mm : 0.0997F;
      });
  EXPECT_NEAR(static_cast<double>(smallest->pixel_mm), 0.0997, 1e-4);
  EXPECT_LE(static_cast<double>(largest->pixel_mm), 0.1005);
  EXPECT_GT(fine.coverage.c1(), 0.5 * kTop);
  scene.coverage.max_pixel_mm = 0.0990;
  const SceneCoverage none = cover(scene);
  EXPECT_EQ(none.coverage.c1(), 0.0);
  EXPECT_NEAR(none.state_shares[static_cast<std::size_t>(CellState::kCoarse)], kTop, 1e-9);
}

// The plate's top lies 1 mm before the plane in focus: pupil x image distance in px x (1 / 299 -
// 1 / 300). With a pupil of 10 mm and 15.517 / 0.005 = 3103 px that is 31030 x 1.1148e-5 = 0.346
// px.
TEST(CoverScene, LeavesOutWhatIsOutOfFocus) {
  SceneSettings scene = plate();
  scene.camera.object_pixel_mm = 0.0;
  scene.camera.pixel_mm = 0.005;
  scene.camera.focal_mm = 14.75409836;  // focused at 300 mm: image distance 15.517 mm
  scene.lens = {.focus_mm = 300.0, .f_number = 1.475409836};  // pupil of 10 mm
  const CoverageView view = coverage_view(scene.camera, scene.lens, scene.viewpoint());
  EXPECT_NEAR(view.lens.aperture_mm, 10.0, 1e-6);
  const double blur_px = 10.0 * view.camera.intrinsics().focal_px.x() * (1.0 / 299.0 - 1.0 / 300.0);
  EXPECT_NEAR(blur_px, 0.346, 0.005);
  scene.coverage.max_blur_px = 1.01 * blur_px;
  EXPECT_NEAR(cover(scene).coverage.c1(), kTop, 1e-9);
  scene.coverage.max_blur_px = 0.99 * blur_px;
  const SceneCoverage none = cover(scene);
  EXPECT_EQ(none.coverage.c1(), 0.0);
  EXPECT_NEAR(none.state_shares[static_cast<std::size_t>(CellState::kBlurred)], kTop, 1e-9);
}

TEST(CoverScene, CountsTwoViewsOnlyWhenTheyLookFromDirectionsApart) {
  SceneSettings scene = plate();
  scene.viewpoints = {viewpoint_at({0.0, 0.0, 300.0}),
                      viewpoint_at({20.0, 0.0, 300.0}),
                      viewpoint_at({150.0, 0.0, 300.0})};
  const SceneCoverage covered = cover(scene);
  ASSERT_EQ(covered.coverage.ck.size(), 3U);
  EXPECT_NEAR(covered.coverage.ck[1], kTop, 0.002);  // the third from 27 degrees beside
  EXPECT_EQ(covered.coverage.ck[2], 0.0);            // the second from 4 degrees beside the first
  ThreadPool pool(2);
  SceneStore store(pool);
  EXPECT_EQ(coverage_scores(store, scene).at("coverage.c2"), covered.coverage.ck[1]);
  scene.coverage.separation_rad = 0.0;
  EXPECT_NEAR(cover(scene).coverage.ck[2], kTop, 0.002);
}

TEST(CoverScene, ChoosesTheViewsThatSeeMost) {
  SceneSettings scene = plate();
  scene.viewpoints = {viewpoint_at({0.0, 0.0, 300.0}),
                      viewpoint_at({20.0, 0.0, 300.0}),
                      viewpoint_at({0.0, 0.0, -300.0}),
                      viewpoint_at({300.0, 0.0, 0.0})};
  scene.coverage.choose = 2;
  for (const auto method : {CoverageSettings::Choice::kGreedy, CoverageSettings::Choice::kExact}) {
    scene.coverage.choice = method;
    const SceneCoverage covered = cover(scene);
    ASSERT_TRUE(covered.choice.has_value());
    EXPECT_THAT(covered.used, ::testing::ElementsAre(0U, 2U));
    EXPECT_NEAR(covered.coverage.c1(), 2.0 * kTop, 1e-9);
    EXPECT_EQ(covered.coverage.views.size(), 2U);
    EXPECT_EQ(covered.visibility.num_views(), 4U);
  }
}

TEST(CoverScene, ProposesViewsAlongTheSurface) {
  SceneSettings scene = gear_scene();
  scene.viewpoint_set.source = ViewpointSource::kSurface;
  scene.viewpoint_set.count = 24;
  scene.coverage.choose = 6;
  scene.coverage.choice = CoverageSettings::Choice::kExact;
  scene.coverage.points = 4000;
  const SceneCoverage covered = cover(scene);
  EXPECT_EQ(covered.viewpoints.size(), 24U);
  EXPECT_EQ(covered.used.size(), 6U);
  EXPECT_TRUE(covered.choice->is_proven);
  EXPECT_GT(covered.coverage.c1(), 0.6);
  EXPECT_NEAR(covered.choice->share, covered.coverage.c1(), 1e-9);
}

TEST(CoverScene, IsTheSameForAnyNumberOfThreads) {
  const SceneSettings scene = gear_scene();
  const SceneCoverage one = cover(scene, 1);
  const SceneCoverage seven = cover(scene, 7);
  EXPECT_EQ(one.coverage.c1(), seven.coverage.c1());
  EXPECT_EQ(one.coverage.ck, seven.coverage.ck);
  EXPECT_EQ(one.rays, seven.rays);
  for (std::size_t view = 0; view < one.visibility.num_views(); ++view) {
    EXPECT_TRUE(std::ranges::equal(one.visibility.row(view), seven.visibility.row(view)));
  }
}

TEST(CoverScene, RefusesACameraInsideThePart) {
  SceneSettings scene = plate();
  scene.viewpoints.push_back(viewpoint_at({0.0, 0.0, 0.5}));
  EXPECT_THAT([&] { cover(scene); }, ThrowsMessage<ConfigError>(HasSubstr("viewpoint.1")));
}

}  // namespace
}  // namespace glint
