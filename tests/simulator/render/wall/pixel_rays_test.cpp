// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/wall/pixel_rays.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

// 200 x 100 pixels of 0.25 mm, 300 mm away.
TEST(PixelRays, AreTheCamerasAlsoBesideThePart) {
  const test::FootprintBench bench(test::bench_strip(), test::bench_camera());
  const auto rays = PixelRays::through(bench.rays, bench.camera_mm);
  ASSERT_TRUE(rays);
  int beside = 0;
  for (int y = 0; y < bench.rays.height_px; ++y) {
    for (int x = 0; x < bench.rays.width_px; ++x) {
      const Vector3d to = rays->point(x, y) - bench.camera_mm;
      EXPECT_NEAR(to.norm(), 300.0, 3.0);
      // The ray through the pixel's middle, by the camera itself.
      const auto in_camera = bench.camera.ray_through(Eigen::Vector2d(x + 0.5, y + 0.5));
      ASSERT_TRUE(in_camera);
      const Vector3d direction = bench.camera_from_world.rotation.transpose() * *in_camera;
      const double off_mm = to.cross(direction.normalized()).norm();
      EXPECT_LT(off_mm, 0.05) << x << " " << y;
      beside += bench.rays.coverage(x, y) > 0.0F ? 0 : 1;
    }
  }
  EXPECT_GT(beside, 100);
}

/// A plane z = 0 seen from (0, 0, 300) through a lens: 0.5 mm a pixel in the middle.
VisibilityBuffer plane_through_lens(double distortion) {
  VisibilityBuffer seen;
  seen.width_px = 101;
  seen.height_px = 61;
  for (ImageF* image : {&seen.coverage, &seen.seen_x, &seen.seen_y, &seen.seen_z}) {
    *image = ImageF(seen.width_px, seen.height_px);
  }
  for (int y = 0; y < seen.height_px; ++y) {
    for (int x = 0; x < seen.width_px; ++x) {
      const double u = 0.5 * (x - 50.0);
      const double v = 0.5 * (y - 30.0);
      const double factor = 1.0 + distortion * (u * u + v * v);
      seen.coverage(x, y) = 1.0F;
      seen.seen_x(x, y) = static_cast<float>(factor * u);
      seen.seen_y(x, y) = static_cast<float>(factor * v);
    }
  }
  return seen;
}

TEST(PixelRays, AreNotGuessedThroughALensThatDistorts) {
  const Vector3d camera_mm(0.0, 0.0, 300.0);
  EXPECT_TRUE(PixelRays::through(plane_through_lens(0.0), camera_mm));
  EXPECT_FALSE(PixelRays::through(plane_through_lens(2e-4), camera_mm));
}

TEST(PixelRays, NeedEnoughOfThePart) {
  VisibilityBuffer seen = plane_through_lens(0.0);
  for (int y = 0; y < seen.height_px; ++y) {
    std::fill_n(seen.coverage.row(y), 90, 0.0F);
  }
  EXPECT_FALSE(PixelRays::through(seen, Vector3d(0.0, 0.0, 300.0)));
}

}  // namespace
}  // namespace glint
