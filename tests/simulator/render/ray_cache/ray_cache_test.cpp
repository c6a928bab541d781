// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/ray_cache/ray_cache.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include "tests/simulator/render/render_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

Vector3d direction_of(const RayCache& rays, std::size_t i) {
  return vector_of(rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]);
}

Vector3d origin_of(const RayCache& rays, std::size_t i) {
  return vector_of(rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]);
}

const CameraSettings kSmallCamera = {
    .width_px = 160, .height_px = 90, .object_pixel_mm = 0.4, .working_distance_mm = 300.0};

// A sphere cap of radius 40 and height 20: its box is 20 high and its origin in the middle, so the
// sphere's centre is 10 - 40 = -30 mm. Every escaping ray is the closed-form mirror image.
TEST(RayCache, SphereReflectsAsTheClosedFormSays) {
  const test::Bench bench(
      {.shape = PartSettings::Shape::kSphereCap, .radius_mm = 40.0, .height_mm = 20.0},
      kSmallCamera,
      {.rays_per_axis = 1});
  const Vector3d centre(0.0, 0.0, -30.0);
  const PinholeCamera camera(intrinsics_of(kSmallCamera));
  const RigidTransform world_from_camera =
      inverse(camera_from_world(default_viewpoint(kSmallCamera)));
  int checked = 0;
  for (int y = 0; y < bench.rays.height_px; ++y) {
    for (int x = 0; x < bench.rays.width_px; ++x) {
      const auto i = static_cast<std::size_t>(y * bench.rays.width_px + x);
      if (bench.rays.weight[i] <= 0.0F) {
        continue;
      }
      const Vector3d d = world_from_camera.rotation * *camera.ray_through({x + 0.5, y + 0.5});
      const Vector3d o = bench.camera_mm - centre;
      const double b = o.dot(d);
      const double t = -b - std::sqrt(b * b - o.squaredNorm() + 1600.0);
      const Vector3d p = bench.camera_mm + t * d;
      const Vector3d n = (p - centre) / 40.0;
      EXPECT_LT((origin_of(bench.rays, i) - p).norm(), 1e-5);  // float of 30 mm carries 2e-6
      EXPECT_LT((direction_of(bench.rays, i) - (d - 2.0 * d.dot(n) * n)).norm(), 1e-6);
      ++checked;
    }
  }
  EXPECT_GT(checked, 5000);
  EXPECT_EQ(bench.rays.counts.followed, 0);
  EXPECT_EQ(bench.rays.counts.blocked, 0);
}

TEST(RayCache, TakesTwentyEightBytesARay) {
  const test::Bench bench(test::plate(), kSmallCamera, {.rays_per_axis = 2});
  const RayCache& rays = bench.rays;
  const std::size_t bytes =
      sizeof(float) * (rays.origin_x.size() + rays.origin_y.size() + rays.origin_z.size() +
                       rays.direction_x.size() + rays.direction_y.size() + rays.direction_z.size() +
                       rays.weight.size());
  EXPECT_EQ(bytes, 28U * 4U * static_cast<std::size_t>(rays.num_pixels()));
}

// Memory is not cleared beforehand: small parts, where all rays are set as missed first, and large
// ones, where rays are set one by one, leave nothing of what was in it.
TEST(RayCache, RaysBesideThePartAreSet) {
  constexpr int kGarbage = 0xA5;
  mallopt(M_PERTURB, kGarbage);
  for (const double pixel_mm : {0.4, 2.0}) {
    for (const int per_axis : {1, 2}) {
      const test::Bench bench(
          test::plate(), test::far_camera(157, 90, pixel_mm), {.rays_per_axis = per_axis});
      const RayCache& rays = bench.rays;
      std::int64_t missed = 0;
      for (std::size_t i = 0; i < rays.weight.size(); ++i) {
        if (rays.weight[i] == 0.0F) {
          ASSERT_EQ(origin_of(rays, i), Vector3d::Zero()) << i;
          ASSERT_EQ(direction_of(rays, i), -Vector3d::UnitZ()) << i;
          ++missed;
        } else {
          ASSERT_EQ(rays.weight[i], 1.0F) << i;
        }
      }
      EXPECT_EQ(missed, rays.counts.camera - rays.counts.part);
      EXPECT_GT(missed, 100);
      double covered = 0.0;
      for (std::size_t p = 0; p < rays.coverage.size(); ++p) {
        const auto coverage = static_cast<double>(rays.coverage.values()[p]);
        covered += coverage;
        ASSERT_EQ(rays.seen_z.values()[p] == 0.0F, coverage == 0.0) << p;
      }
      EXPECT_EQ(covered * per_axis * per_axis, static_cast<double>(rays.counts.part));
    }
  }
  mallopt(M_PERTURB, 0);
}

TEST(ShareOfPart, CountsPixelsThatSeeThePart) {
  VisibilityBuffer seen = {.width_px = 4, .height_px = 1, .coverage = ImageF(4, 1)};
  seen.coverage(0, 0) = 1.0F;
  seen.coverage(1, 0) = 0.25F;
  seen.coverage(3, 0) = 0.5F;
  EXPECT_EQ(share_of_part(Mask(), seen), 0.0);
  Mask mask(4, 1);
  EXPECT_EQ(share_of_part(mask, seen), 0.0);
  mask(1, 0) = 1;
  EXPECT_DOUBLE_EQ(share_of_part(mask, seen), 1.0 / 3.0);
  seen.coverage = ImageF(4, 1);
  EXPECT_EQ(share_of_part(Mask(4, 1), seen), 0.0);
}

/// A groove of two planes at 45 degrees, 60 mm long and 30 mm wide.
Part groove() {
  Part part;
  part.name = "groove";
  part.mesh.vertices_mm = {
      {-30, -15, 15}, {30, -15, 15}, {-30, 0, 0}, {30, 0, 0}, {-30, 15, 15}, {30, 15, 15}};
  part.mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}};
  smooth_normals(part.mesh, 0.5);
  part.box_in_part_mm = bounding_box(part.mesh);
  return part;
}

// A vertical ray at y goes level to the other side at -y and from there straight up again.
TEST(RayCache, AGrooveOfFortyFiveDegreesSendsRaysBackAfterTwoReflections) {
  const test::Bench bench(
      groove(), test::far_camera(160, 90, 0.41), {.rays_per_axis = 1, .max_bounces = 2});
  EXPECT_EQ(bench.rays.counts.followed, bench.rays.counts.part);
  for (int y = 0; y < bench.rays.height_px; ++y) {
    const auto i = static_cast<std::size_t>(y * bench.rays.width_px + 80);
    const double y_mm = 0.41 * (45.0 - (y + 0.5));
    if (std::abs(y_mm) < 14.5) {
      ASSERT_EQ(bench.rays.weight[i], 1.0F) << y;
      EXPECT_NEAR(static_cast<double>(bench.rays.origin_y[i]), -y_mm, 0.01) << y;
      EXPECT_NEAR(bench.rays.direction_z[i], 1.0F, 1e-6F) << y;
    }
  }
}

TEST(RayCache, RaysGivenUpAreDarkAndCounted) {
  const test::Bench bench(
      groove(), test::far_camera(160, 90, 0.41), {.rays_per_axis = 1, .max_bounces = 1});
  EXPECT_EQ(bench.rays.counts.followed, 0);
  EXPECT_EQ(bench.rays.counts.blocked, bench.rays.counts.part);
  for (const float weight : bench.rays.weight) {
    EXPECT_EQ(weight, 0.0F);
  }
}

TEST(RayCache, EachReflectionCostsTheReflectance) {
  const RenderSettings half = {.rays_per_axis = 1, .max_bounces = 8, .reflectance = 0.5};
  const test::Bench twice(groove(), test::far_camera(160, 90, 0.41), half);
  const test::Bench once(test::plate(), kSmallCamera, half);
  EXPECT_EQ(*std::max_element(twice.rays.weight.begin(), twice.rays.weight.end()), 0.25F);
  EXPECT_EQ(*std::max_element(once.rays.weight.begin(), once.rays.weight.end()), 0.5F);
}

// What the pixel sees is the first hit, wherever its light comes from in the end.
TEST(RayCache, APixelSeesWhereItsRaysMetThePartFirst) {
  const test::Bench bench(
      groove(), test::far_camera(160, 90, 0.41), {.rays_per_axis = 2, .max_bounces = 2});
  for (int y = 10; y < 80; ++y) {
    const double y_mm = 0.41 * (45.0 - (y + 0.5));
    EXPECT_NEAR(static_cast<double>(bench.rays.seen_y(80, y)), y_mm, 0.01) << y;
    EXPECT_NEAR(static_cast<double>(bench.rays.seen_z(80, y)), std::abs(y_mm), 0.15) << y;
  }
}

TEST(RayCache, APixelOnThePartIsExactlyWholeForAnyNumberOfRays) {
  for (int per_axis = 1; per_axis <= 16; ++per_axis) {
    const test::Bench bench(
        test::plate(),
        {.width_px = 20, .height_px = 10, .object_pixel_mm = 0.5, .working_distance_mm = 300.0},
        {.rays_per_axis = per_axis});
    for (const float coverage : bench.rays.coverage.values()) {
      ASSERT_EQ(coverage, 1.0F) << per_axis;
    }
  }
}

TEST(RayCache, RaysThatDoNotFitIntoMemoryAreRefused) {
  EXPECT_THAT(
      [] {
        const test::Bench bench(
            test::plate(), test::far_camera(32768, 32768, 0.1), {.rays_per_axis = 16});
      },
      ::testing::ThrowsMessage<ConfigError>(::testing::StartsWith("render.rays_per_axis: ")));
}

TEST(RayCache, TeethOfAGearReflectEachOther) {
  PartSettings gear;
  gear.shape = PartSettings::Shape::kSpurGear;
  const test::Bench bench(gear, kSmallCamera, {.rays_per_axis = 1, .max_bounces = 8});
  EXPECT_GT(bench.rays.counts.followed, bench.rays.counts.part / 50);
}

TEST(RayCache, APartOutsideTheImageIsAnError) {
  PartSettings away = test::plate();
  away.position_mm = {500.0, 0.0, 0.0};
  try {
    const test::Bench bench(away, kSmallCamera, {.rays_per_axis = 1});
    FAIL() << "a part outside the image was accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), ::testing::StartsWith("camera: the part is outside the image"));
  }
}

// Embree shares oneTBB with us and could limit it; then the next test would prove nothing.
TEST(RayCache, TracingLeavesSeveralThreadsToThePool) {
  const test::Bench bench(test::plate(), kSmallCamera, {.rays_per_axis = 1});
  const ThreadPool pool(7);
  EXPECT_GE(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism), 7U);
}

TEST(RayCache, IsTheSameBytesForOneTwoAndSevenThreads) {
  const tbb::global_control seven(tbb::global_control::max_allowed_parallelism, 7);
  std::vector<HeightFeature> features = {test::bump(0.02)};
  const test::Bench one(test::plate(), kSmallCamera, {}, features, 1);
  for (const int threads : {2, 7}) {
    const test::Bench more(test::plate(), kSmallCamera, {}, features, threads);
    EXPECT_EQ(one.rays.origin_x, more.rays.origin_x) << threads;
    EXPECT_EQ(one.rays.origin_z, more.rays.origin_z) << threads;
    EXPECT_EQ(one.rays.direction_x, more.rays.direction_x) << threads;
    EXPECT_EQ(one.rays.weight, more.rays.weight) << threads;
    EXPECT_EQ(one.rays.coverage, more.rays.coverage) << threads;
    EXPECT_EQ(one.rays.counts.part, more.rays.counts.part) << threads;
  }
}

}  // namespace
}  // namespace glint
