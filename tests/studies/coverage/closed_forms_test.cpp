// SPDX-License-Identifier: GPL-3.0-or-later
//
// Coverage of parts for which it can be written down. C1 is to be right within 0.2 % of the
// surface.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/studies/coverage/coverage_scenes.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

constexpr double kTolerance = 0.002;

/// Share of a sphere that is seen from a distance under at most an angle to the normal. In the
/// triangle of centre, camera and point sin(at the camera) = R sin(incidence) / D, and the polar
/// angle is the incidence less that. A cap up to a polar angle a has (1 - cos a) / 2.
double cap_share(double radius_mm, double distance_mm, double incidence_rad) {
  const double polar_rad =
      incidence_rad - std::asin(radius_mm * std::sin(incidence_rad) / distance_mm);
  return 0.5 * (1.0 - std::cos(polar_rad));
}

TEST(CoverScene, OfASphereIsTheCapThatTheLargestAngleAllows) {
  SceneSettings scene = sphere_scene();
  for (const double degrees : {20.0, 45.0, 60.0, 75.0, 90.0}) {
    scene.coverage.max_incidence_rad = degrees * kRadPerDeg;
    const SceneCoverage covered = cover(scene);
    EXPECT_NEAR(covered.coverage.c1(), cap_share(25.0, 300.0, degrees * kRadPerDeg), kTolerance)
        << degrees << " degrees";
  }
  // 90 degrees: all that is seen, sin(polar) = cos of the angle at the camera; R / D = 1 / 12.
  EXPECT_NEAR(cap_share(25.0, 300.0, 0.5 * kPi), 0.5 * (1.0 - 1.0 / 12.0), 1e-12);
}

TEST(CoverScene, OfASphereFromTwoSidesIsTwoCapsThatNoViewShares) {
  SceneSettings scene = sphere_scene();
  scene.viewpoints = {viewpoint_at({0.0, 0.0, 300.0}), viewpoint_at({0.0, 0.0, -300.0})};
  const SceneCoverage covered = cover(scene);
  const double cap = cap_share(25.0, 300.0, 60.0 * kRadPerDeg);
  EXPECT_NEAR(covered.coverage.c1(), 2.0 * cap, kTolerance);
  EXPECT_EQ(covered.coverage.ck.at(1), 0.0);
  EXPECT_NEAR(covered.coverage.views[1].adds, cap, kTolerance);
  // What is left is one belt, all around: 4 pi R^2 (1 - 2 cap), 2 R sin(polar) across.
  EXPECT_NEAR(
      covered.gap.area_mm2, 4.0 * kPi * 625.0 * (1.0 - 2.0 * cap), 4.0 * kPi * 625.0 * kTolerance);
  EXPECT_NEAR(covered.gap.size_mm, 50.0, 1.0);
}

// The camera stands at x = 40, z = 150 over the cup's floor, whose rim lies at z = 30. From there
// the rim is a circle on the floor: heights above the floor scale by s = 150 / (150 - 30) = 1.25,
// so its radius is 25 mm and its middle -(s - 1) 40 = -10 mm. The floor, 20 mm, is seen where both
// circles overlap.
double circles_overlap(double a, double b, double distance) {
  const double ca = (distance * distance + a * a - b * b) / (2.0 * distance * a);
  const double cb = (distance * distance + b * b - a * a) / (2.0 * distance * b);
  const double kite =
      std::sqrt((-distance + a + b) * (distance + a - b) * (distance - a + b) * (distance + a + b));
  return a * a * std::acos(ca) + b * b * std::acos(cb) - 0.5 * kite;
}

TEST(CoverScene, OfACupsFloorIsWhatTheRimsShadowLeaves) {
  const TemporaryFolder folder;
  write_cup(folder / "cup.ply");
  SceneSettings scene = cup_scene(folder / "cup.ply");
  scene.viewpoints = {{.position_mm = {40.0, 0.0, 150.0}, .direction = {-40.0, 0.0, -150.0}}};
  scene.camera.object_pixel_mm = 0.2;
  const SceneCoverage covered = cover(scene);
  double floor_mm2 = 0.0;
  double seen_mm2 = 0.0;
  for (std::size_t i = 0; i < covered.cells.size(); ++i) {
    if (std::abs(covered.cells.points_mm[i].z()) < 1e-9) {
      floor_mm2 += covered.cells.areas_mm2[i];
      seen_mm2 += covered.of_cell[i].views > 0 ? covered.cells.areas_mm2[i] : 0.0;
    }
  }
  EXPECT_NEAR(floor_mm2, kPi * 400.0, 0.1);
  const double shares = kTolerance * covered.area_mm2;
  EXPECT_NEAR(seen_mm2, circles_overlap(20.0, 25.0, 10.0), shares);
}

// On the axis at z = 150 a place of the inner wall is seen under cos = 20 / sqrt(20^2 + (150 -
// z)^2). With 84 degrees that is 150 - z <= 20 tan(84 deg) = 190.3: all of the wall; with 82
// degrees 150 - z <= 142.3: from z = 7.7 upwards. The floor is seen whole, tan = r / 150; the rim
// is a ring of 20 to 22 mm.
TEST(CoverScene, OfACupFromAboveIsFloorRimAndTheWallsUpperPart) {
  const TemporaryFolder folder;
  write_cup(folder / "cup.ply");
  SceneSettings scene = cup_scene(folder / "cup.ply");
  scene.viewpoints = {viewpoint_at({0.0, 0.0, 150.0})};
  scene.camera.object_pixel_mm = 0.2;
  const double floor_mm2 = kPi * 400.0;
  const double rim_mm2 = kPi * (484.0 - 400.0);
  for (const double degrees : {60.0, 82.0, 84.0}) {
    scene.coverage.max_incidence_rad = degrees * kRadPerDeg;
    const SceneCoverage covered = cover(scene);
    const double lowest_mm = 150.0 - 20.0 * std::tan(degrees * kRadPerDeg);
    const double wall_mm = std::clamp(kCupDepth_mm - lowest_mm, 0.0, kCupDepth_mm);
    const double wall_mm2 = 2.0 * kPi * kCupRadius_mm * wall_mm;
    const double whole_mm2 = floor_mm2 + rim_mm2 + 2.0 * kPi * kCupRadius_mm * 30.0 +
                             2.0 * kPi * 22.0 * 32.0 + kPi * 484.0;
    EXPECT_NEAR(covered.area_mm2, whole_mm2, 1e-4 * whole_mm2);
    EXPECT_NEAR(covered.coverage.c1(), (floor_mm2 + rim_mm2 + wall_mm2) / whole_mm2, kTolerance)
        << degrees << " degrees";
  }
}

// A plate of 60 x 40 mm looked at from 300 mm straight above: a pixel at the middle covers 0.1 mm;
// at 300 mm sideways tilt the longer way grows by 1 / cos(incidence) and the distance.
TEST(PixelOnPlane, IsThePixelAcrossTheViewAndLongerAlongIt) {
  const PinholeIntrinsics in = {
      .width_px = 100, .height_px = 100, .focal_px = {3000.0, 3000.0}, .center_px = {50.0, 50.0}};
  EXPECT_NEAR(pixel_on_plane_mm(in, {0, 0, 300.0}, {0, 0, -1}), 0.1, 1e-12);
  const double tilt_rad = 60.0 * kRadPerDeg;
  EXPECT_NEAR(pixel_on_plane_mm(in, {0, 0, 300.0}, {std::sin(tilt_rad), 0.0, -std::cos(tilt_rad)}),
              0.2,
              1e-12);
  // Facing the camera beside the axis: the ray is 1 / cos(30 deg) longer, and pixels are flatter.
  const double aside_rad = 30.0 * kRadPerDeg;
  const Eigen::Vector3d point_mm(300.0 * std::tan(aside_rad), 0.0, 300.0);
  EXPECT_NEAR(pixel_on_plane_mm(in, point_mm, -point_mm.normalized()), 0.1, 1e-12);
}

}  // namespace
}  // namespace glint
