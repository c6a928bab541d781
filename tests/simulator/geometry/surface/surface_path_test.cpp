// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/surface/surface_path.h"

#include <cmath>

#include <gtest/gtest.h>

#include "simulator/geometry/surface/surface_sampling.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

Part cylinder_for_paths(double facets_mm) {
  return build_part({.shape = PartSettings::Shape::kCylinder,
                     .length_mm = 80.0,
                     .radius_mm = 10.0,
                     .facets_mm = facets_mm});
}

Part plate_for_paths(double facets_mm) {
  return build_part({.shape = PartSettings::Shape::kPlate,
                     .length_mm = 60.0,
                     .width_mm = 40.0,
                     .thickness_mm = 2.0,
                     .facets_mm = facets_mm});
}

/// On top of a part, u turned from x.
SurfacePlace place_on_top(const Part& part, const Bvh& bvh, double x_mm, double angle_rad) {
  return *place_on_surface(part, bvh, x_mm, 0.0, angle_rad);
}

/// A point of the cylinder y^2 + z^2 = 100 along a helix from its top that makes an angle with x.
Vector3d helix(double arc_mm, double angle_rad) {
  const double turn_rad = arc_mm * std::sin(angle_rad) / 10.0;
  return {arc_mm * std::cos(angle_rad), 10.0 * std::sin(turn_rad), 10.0 * std::cos(turn_rad)};
}

double largest_error_to_helix(const Part& part, double step_mm) {
  const Bvh bvh(part.mesh);
  constexpr double kAngle_rad = 0.7;
  double worst_mm = 0.0;
  for (const SurfacePathPoint& at :
       surface_path(part, bvh, place_on_top(part, bvh, 0.0, kAngle_rad), 20.0, step_mm)) {
    worst_mm = std::max(worst_mm, (at.point_mm - helix(at.arc_mm, kAngle_rad)).norm());
  }
  return worst_mm;
}

// Along u from a point c of a sphere of radius R: R (cos(s / R) n + sin(s / R) u), with the tangent
// cos(s / R) u - sin(s / R) n.
TEST(SurfacePath, IsAGreatCircleOnASphere) {
  const Part sphere = sphere_part(25.0);
  const Bvh bvh(sphere.mesh);
  for (const double angle_rad : {0.0, 1.0, -2.5}) {
    const SurfacePlace place = place_on_top(sphere, bvh, 8.0, angle_rad);
    const auto path = surface_path(sphere, bvh, place, 30.0, 0.5);
    ASSERT_EQ(path.size(), 121U);
    for (const SurfacePathPoint& at : path) {
      const double turn_rad = at.arc_mm / 25.0;
      const Vector3d normal = std::cos(turn_rad) * place.normal + std::sin(turn_rad) * place.u_axis;
      EXPECT_LT((at.point_mm - 25.0 * normal).norm(), 1e-6);
      EXPECT_LT((at.normal - normal).norm(), 1e-7);
      EXPECT_LT((at.tangent - std::cos(turn_rad) * place.u_axis + std::sin(turn_rad) * place.normal)
                    .norm(),
                1e-7);
    }
  }
}

TEST(SurfacePath, IsAHelixOnACylinder) {
  EXPECT_LT(largest_error_to_helix(cylinder_for_paths(0.0), 0.5), 1e-6);
  EXPECT_LT(largest_error_to_helix(cylinder_for_paths(0.0), 5.0), 1e-6);
}

// A quarter of the facets' distance leaves a quarter of the error or less.
TEST(SurfacePath, OnFacetsItIsAsNearAsTheFacets) {
  const double coarse_mm = largest_error_to_helix(cylinder_for_paths(0.02), 0.05);
  const double fine_mm = largest_error_to_helix(cylinder_for_paths(0.002), 0.05);
  EXPECT_LT(coarse_mm, 0.04);
  EXPECT_LT(fine_mm, 0.004);
  EXPECT_GT(coarse_mm, 1e-4);
}

TEST(SurfacePath, IsStraightOnAPlate) {
  for (const double facets_mm : {0.0, 0.01}) {
    const Part plate = plate_for_paths(facets_mm);
    const Bvh bvh(plate.mesh);
    const SurfacePlace place = place_on_top(plate, bvh, 3.0, 0.4);
    for (const SurfacePathPoint& at : surface_path(plate, bvh, place, 12.0, 0.3)) {
      EXPECT_LT((at.point_mm - place.centre_mm - at.arc_mm * place.u_axis).norm(), 1e-6);
      EXPECT_LT((at.normal - Vector3d::UnitZ()).norm(), 1e-9);
    }
  }
}

// From x = 25 mm on the plate's top (z = 1 mm), whose edge is at x = 30 mm.
TEST(SurfacePath, RunsStraightOffAnEdge) {
  for (const double facets_mm : {0.0, 0.01}) {
    const Part plate = plate_for_paths(facets_mm);
    const Bvh bvh(plate.mesh);
    SurfacePlace place = place_on_top(plate, bvh, 25.0, 0.0);
    place.centre_mm.x() = 25.0;  // the ray found it in float
    const auto path = surface_path(plate, bvh, place, 9.0, 0.13);
    EXPECT_LT((path.back().point_mm - Vector3d(34.0, 0.0, 1.0)).norm(), 1e-9);
    EXPECT_LT((path.back().normal - Vector3d::UnitZ()).norm(), 1e-9);
    EXPECT_LT((path.front().point_mm - Vector3d(16.0, 0.0, 1.0)).norm(), 1e-9);
  }
}

/// An L of two unit squares: a floor z = 0 and a wall x = 10 that rises from it.
Part corner_part() {
  Part part;
  part.mesh.vertices_mm = {{0.0, -10.0, 0.0},
                           {10.0, -10.0, 0.0},
                           {10.0, 10.0, 0.0},
                           {0.0, 10.0, 0.0},
                           {10.0, -10.0, 10.0},
                           {10.0, 10.0, 10.0}};
  part.mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  smooth_normals(part.mesh, 0.5);
  part.box_in_part_mm = bounding_box(part.mesh);
  return part;
}

TEST(SurfacePath, RunsIntoAWallRatherThanUpIt) {
  const Part part = corner_part();
  const Bvh bvh(part.mesh);
  const auto path = surface_path(part, bvh, place_on_top(part, bvh, 6.0, 0.0), 6.0, 0.25);
  EXPECT_LT((path.back().point_mm - Vector3d(12.0, 0.0, 0.0)).norm(), 1e-6);
}

// A bend of 20 degrees is followed: 4 mm on the floor, then 5 mm up the slope.
TEST(SurfacePath, FollowsAGentleBend) {
  Part part = corner_part();
  const double bend_rad = 20.0 * kRadPerDeg;
  for (const std::size_t i : {4U, 5U}) {
    part.mesh.vertices_mm[i].x() = 10.0 + 10.0 * std::cos(bend_rad);
    part.mesh.vertices_mm[i].z() = 10.0 * std::sin(bend_rad);
  }
  smooth_normals(part.mesh, 0.1);
  const Bvh bvh(part.mesh);
  const auto path = surface_path(part, bvh, place_on_top(part, bvh, 6.0, 0.0), 9.0, 0.1);
  const Vector3d expected(10.0 + 5.0 * std::cos(bend_rad), 0.0, 5.0 * std::sin(bend_rad));
  EXPECT_LT((path.back().point_mm - expected).norm(), 0.02);
  EXPECT_LT((path.back().tangent - (expected - Vector3d(10.0, 0.0, 0.0)).normalized()).norm(),
            1e-6);
}

TEST(SurfacePath, FramesAreOrthonormalOnRandomPlacesOfAGear) {
  const Part gear = build_part({.shape = PartSettings::Shape::kSpurGear,
                                .gear = {.teeth = 14, .face_width_mm = 12.0, .bore_mm = 8.0}});
  const Bvh bvh(gear.mesh);
  const AreaSampler sampler(gear.mesh);
  Rng rng(5, Stream::kTest, 1);
  for (int i = 0; i < 1000; ++i) {
    const auto sample = sampler.draw(gear.mesh, rng);
    const SurfacePoint point = smooth_point(gear, sample.triangle, sample.point_mm);
    const SurfacePlace place =
        oriented_place(gear, point.point_mm, point.normal, rng.uniform(-kPi, kPi));
    const auto path = surface_path(gear, bvh, place, 3.0, 0.5);
    for (std::size_t k = 0; k < path.size(); ++k) {
      EXPECT_NEAR(path[k].normal.norm(), 1.0, 1e-12);
      EXPECT_NEAR(path[k].tangent.norm(), 1.0, 1e-12);
      EXPECT_LT(std::abs(path[k].tangent.dot(path[k].normal)), 1e-12);
      if (k > 0) {
        EXPECT_NEAR((path[k].point_mm - path[k - 1].point_mm).norm(), 0.5, 0.1);
      }
    }
  }
}

TEST(SurfacePath, WithoutLengthItIsThePlace) {
  const Part plate = plate_for_paths(0.0);
  const Bvh bvh(plate.mesh);
  const auto path = surface_path(plate, bvh, place_on_top(plate, bvh, 1.0, 0.0), 0.0, 0.1);
  ASSERT_EQ(path.size(), 1U);
  EXPECT_EQ(path[0].arc_mm, 0.0);
}

}  // namespace
}  // namespace glint
