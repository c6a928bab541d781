// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/pinhole_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A 5 Mpx camera with a 16 mm lens and visible barrel distortion.
PinholeIntrinsics typical_intrinsics() {
  return {.width_px = 2448,
          .height_px = 2048,
          .focal_px = {4637.0, 4640.0},
          .center_px = {1230.5, 1017.0},
          .radial = {-0.12, 0.08, -0.01},
          .tangential = {3e-4, -2e-4}};
}

// x/z = 0.1, y/z = 0.2, r^2 = 0.05, radial factor 1 + 0.5 * 0.05 = 1.025.
// tangential x: 2 * 0.01 * 0.02 + 0.02 * (0.05 + 2 * 0.01) = 0.0018; y: 0.01 * (0.05 + 0.08) +
// 2 * 0.02 * 0.02 = 0.0021. u = 500 + 1000 * (0.1025 + 0.0018), v = 500 + 1000 * (0.205 + 0.0021).
TEST(PinholeCamera, MatchesAHandWorkedExample) {
  const PinholeCamera camera({.width_px = 1000,
                              .height_px = 1000,
                              .focal_px = {1000, 1000},
                              .center_px = {500, 500},
                              .radial = {0.5, 0, 0},
                              .tangential = {0.01, 0.02}});
  const Vector2d pixel_px = *camera.project({10, 20, 100});
  EXPECT_NEAR(pixel_px.x(), 604.3, 1e-9);
  EXPECT_NEAR(pixel_px.y(), 707.1, 1e-9);
}

TEST(PinholeCamera, RayThroughInvertsProjectOverTheWholeImage) {
  const PinholeCamera camera(typical_intrinsics());
  for (int v = 0; v <= 2048; v += 64) {
    for (int u = 0; u <= 2448; u += 64) {
      SCOPED_TRACE(::testing::Message() << "pixel " << u << ", " << v);
      const auto ray = camera.ray_through(Vector2d(u, v));
      ASSERT_TRUE(ray.has_value());
      EXPECT_NEAR(ray->norm(), 1.0, 1e-12);
      const auto pixel_px = camera.project(250.0 * *ray);
      ASSERT_TRUE(pixel_px.has_value());
      EXPECT_LT((*pixel_px - Vector2d(u, v)).norm(), 1e-9);
    }
  }
}

TEST(PinholeCamera, SeesNothingBehindOrOnTheImagePlane) {
  const PinholeCamera camera(typical_intrinsics());
  EXPECT_FALSE(camera.project({0, 0, -1}).has_value());
  EXPECT_FALSE(camera.project({0, 0, 0}).has_value());
}

// With k1 = -0.3 the distorted radius r (1 - 0.3 r^2) stops growing at r = sqrt(1 / 0.9) = 1.0541.
TEST(PinholeCamera, SeesNothingBeyondTheRadiusWhereDistortionTurnsBack) {
  PinholeIntrinsics turning = typical_intrinsics();
  turning.radial = {-0.3, 0, 0};
  const PinholeCamera camera(turning);
  EXPECT_TRUE(camera.project({105.3, 0, 100}).has_value());
  EXPECT_FALSE(camera.project({105.5, 0, 100}).has_value());
}

TEST(PinholeCamera, RejectsDistortionThatFoldsInsideTheImageAndNamesTheRadius) {
  PinholeIntrinsics folding = typical_intrinsics();
  folding.radial = {-8.0, 0.0, 0.0};  // turns at sqrt(1 / 24) = 0.2041
  try {
    const PinholeCamera camera(folding);
    FAIL() << "a folding distortion was accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), ::testing::StartsWith("camera.k1"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("0.2041"));
  }
}

TEST(PinholeCamera, RejectsAnEmptyImageAndAFocalLengthOfZero) {
  PinholeIntrinsics intrinsics = typical_intrinsics();
  intrinsics.height_px = 0;
  EXPECT_THROW(PinholeCamera{intrinsics}, ConfigError);
  intrinsics = typical_intrinsics();
  intrinsics.focal_px.x() = 0.0;
  EXPECT_THROW(PinholeCamera{intrinsics}, ConfigError);
}

}  // namespace
}  // namespace glint
