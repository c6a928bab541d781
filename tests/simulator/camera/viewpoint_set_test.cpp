// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/viewpoint_set.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "core/config/key_writer.h"
#include "core/config/toml.h"
#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector3d;

Vector3d eigen_of(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

TEST(SphereViewpoints, StandOnTheSphereWithinThePolarRangeAndLookAtTheTarget) {
  for (const SphereLayout layout : {SphereLayout::kFibonacci, SphereLayout::kRings}) {
    for (const int count : {1, 2, 12, 100, 1000}) {
      const ViewpointSettings settings = {.count = count,
                                          .layout = layout,
                                          .polar_min_rad = 0.0,
                                          .polar_max_rad = 1.2,
                                          .target_mm = {10.0, -5.0, 3.0}};
      const auto viewpoints = sphere_viewpoints(settings, 250.0);
      ASSERT_EQ(viewpoints.size(), static_cast<std::size_t>(count));
      for (const Viewpoint& v : viewpoints) {
        const Vector3d away = eigen_of(v.position_mm) - Vector3d(10.0, -5.0, 3.0);
        EXPECT_NEAR(away.norm(), 250.0, 1e-9);
        EXPECT_LT((away / 250.0 + eigen_of(v.direction)).norm(), 1e-12);
        EXPECT_LE(std::acos(std::min(1.0, away.z() / 250.0)), 1.2 + 1e-9);
        EXPECT_NEAR(eigen_of(v.direction).dot(eigen_of(v.up)), 0.0, 1e-12);
        EXPECT_GE(v.up[1], -1e-12);
      }
    }
  }
}

// Whole sphere: the mean direction vanishes and each octant's share is 1/8.
TEST(SphereViewpoints, FibonacciSpreadsEvenlyByArea) {
  const auto viewpoints =
      sphere_viewpoints({.count = 4000, .polar_min_rad = 0.0, .polar_max_rad = kPi}, 1.0);
  Vector3d sum = Vector3d::Zero();
  int octant = 0;
  for (const Viewpoint& v : viewpoints) {
    sum += eigen_of(v.position_mm);
    octant += eigen_of(v.position_mm).minCoeff() > 0.0 ? 1 : 0;
  }
  EXPECT_LT(sum.norm() / 4000, 1e-3);
  EXPECT_NEAR(octant, 500, 10);
}

TEST(SphereViewpoints, RingsWithAPoleHaveOnePoseThere) {
  const auto viewpoints = sphere_viewpoints(
      {.count = 50, .layout = SphereLayout::kRings, .polar_min_rad = 0.0, .polar_max_rad = 1.0},
      100.0);
  int poles = 0;
  for (const Viewpoint& v : viewpoints) {
    poles += std::hypot(v.position_mm[0], v.position_mm[1]) < 1e-9 ? 1 : 0;
  }
  EXPECT_EQ(poles, 1);
}

TEST(SphereViewpoints, RefuseAnImpossibleRange) {
  EXPECT_THROW(sphere_viewpoints({.count = 0}, 1.0), ConfigError);
  EXPECT_THROW(sphere_viewpoints({.polar_min_rad = 2.0, .polar_max_rad = 1.0}, 1.0), ConfigError);
  EXPECT_THROW(sphere_viewpoints({}, 0.0), ConfigError);
}

TEST(SurfaceViewpoints, SeeTheirPointInTheMiddleAtTheWorkingDistanceAndTilt) {
  Rng rng(1, Stream::kTest, 0);
  std::vector<Vector3d> points;
  std::vector<Vector3d> normals;
  for (int i = 0; i < 1000; ++i) {
    points.emplace_back(rng.uniform(-50, 50), rng.uniform(-50, 50), rng.uniform(-50, 50));
    normals.emplace_back(rng.normal(), rng.normal(), rng.normal());
  }
  normals[0] = Vector3d(0.0, 3.0, 0.0);  // along up
  const auto viewpoints = surface_viewpoints(points, normals, 146.0, {.tilt_rad = 0.3});
  ASSERT_EQ(viewpoints.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d seen = camera_from_world(viewpoints[i]) * points[i];
    EXPECT_LT((seen - Vector3d(0.0, 0.0, 146.0)).norm(), 1e-9);
    const double cosine = -eigen_of(viewpoints[i].direction).dot(normals[i].normalized());
    EXPECT_NEAR(cosine, std::cos(0.3), 1e-12);
  }
}

TEST(SurfaceViewpoints, RefuseANormalOfZeroAndNan) {
  const std::vector<Vector3d> points = {Vector3d::Zero()};
  const std::vector<Vector3d> none = {Vector3d::Zero()};
  const std::vector<Vector3d> nan = {Vector3d(0.0, std::nan(""), 1.0)};
  EXPECT_THROW(surface_viewpoints(points, none, 1.0, {}), ConfigError);
  EXPECT_THROW(surface_viewpoints(points, nan, 1.0, {}), ConfigError);
}

TEST(ViewpointSettings, KeysAreWrittenAndReadBack) {
  ViewpointSettings settings = {.source = ViewpointSource::kSphere,
                                .count = 7,
                                .layout = SphereLayout::kRings,
                                .polar_min_rad = 10 * kRadPerDeg,
                                .radius_mm = 33.0};
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_keys(writer, settings);
  const ConfigNode parsed = parse_toml(to_toml(table), "s.toml");
  ViewpointSettings again;
  std::vector<Problem> errors;
  KeyReader reader(&parsed, "viewpoints", errors);
  visit_keys(reader, again);
  reader.report_unknown();
  EXPECT_THAT(errors, ::testing::IsEmpty());
  EXPECT_EQ(again.source, ViewpointSource::kSphere);
  EXPECT_EQ(again.layout, SphereLayout::kRings);
  EXPECT_EQ(again.count, 7);
  EXPECT_DOUBLE_EQ(again.polar_min_rad, 10 * kRadPerDeg);
  EXPECT_DOUBLE_EQ(again.polar_max_rad, 70 * kRadPerDeg);
  EXPECT_EQ(again.radius_mm, 33.0);
}

TEST(ViewpointSettings, AFileWithoutItsSourceIsAnErrorWithItsPlace) {
  const ConfigNode root = parse_toml("count = 3\nfile = \"a.csv\"\n", "s.toml");
  ViewpointSettings settings;
  std::vector<Problem> errors;
  KeyReader reader(&root, "viewpoints", errors);
  visit_keys(reader, settings);
  EXPECT_THAT(messages_of(errors),
              ::testing::Contains(::testing::StartsWith(
                  "s.toml:2:1: viewpoints.file: must be given with source = \"file\"")));
}

}  // namespace
}  // namespace glint
