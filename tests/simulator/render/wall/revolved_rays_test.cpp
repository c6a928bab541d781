// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/wall/revolved_rays.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/render/footprint/footprints.h"

namespace glint {
namespace {

/// Rays from inside a tunnel in all directions.
RayCache revolved_test_rays(std::size_t count, double base_mm) {
  RayCache rays;
  Rng rng(3, Stream::kTest, 17);
  const auto add = [](auto& array, double value) { array.push_back(static_cast<float>(value)); };
  for (std::size_t i = 0; i < count; ++i) {
    add(rays.origin_x, rng.uniform(-90.0, 90.0));
    add(rays.origin_y, rng.uniform(-30.0, 30.0));
    add(rays.origin_z, base_mm + rng.uniform(-10.0, 10.0));
    Eigen::Vector3d direction(rng.normal(), rng.normal(), rng.normal());
    direction.normalize();
    add(rays.direction_x, direction.x());
    add(rays.direction_y, direction.y());
    add(rays.direction_z, direction.z());
    rays.weight.push_back(1.0F);
  }
  return rays;
}

Tunnel revolved_test_tunnel(double radius_mm, double base_mm) {
  TunnelSettings settings;
  settings.shape = TunnelSettings::Shape::kSemicylinder;
  settings.radius_mm = radius_mm;
  settings.base_mm = base_mm;
  return Tunnel(settings);
}

TEST(RevolvedRays, MeetEveryRadiusWhereThePlainRaysDo) {
  constexpr double kBase_mm = 7.0;
  const RayCache rays = revolved_test_rays(5000, kBase_mm);
  const RevolvedRays ready = revolve(rays, kBase_mm);
  for (const double radius_mm : {60.0, 150.0, 400.0}) {
    const Tunnel tunnel = revolved_test_tunnel(radius_mm, kBase_mm);
    const WallHits plain = meet_light(rays, tunnel);
    const WallHits revolved = meet_revolved(ready, tunnel);
    for (std::size_t i = 0; i < rays.weight.size(); ++i) {
      const double along = std::abs(static_cast<double>(rays.direction_x[i]));
      const double tolerance_mm = along < 0.999 ? 1e-3 : 0.1;  // x grows without limit there
      const double size_mm = std::abs(static_cast<double>(plain.x_mm[i]));
      ASSERT_NEAR(revolved.x_mm[i], plain.x_mm[i], tolerance_mm + 1e-6 * size_mm);
      ASSERT_NEAR(revolved.y_mm[i], plain.y_mm[i], 1e-3);
      ASSERT_NEAR(revolved.margin_mm[i], plain.margin_mm[i], 1e-3);
    }
  }
}

TEST(RevolvedRays, AreWorkedByHandForOneRay) {
  // From (1, 30, 0) straight up in y-z with slope 1 along x: leaves radius 50 at z = 40 (3-4-5), so
  // x = 1 + 40.
  RayCache rays;
  rays.origin_x = {1.0F};
  rays.origin_y = {30.0F};
  rays.origin_z = {0.0F};
  rays.direction_x = {1.0F};
  rays.direction_y = {0.0F};
  rays.direction_z = {1.0F};
  rays.weight = {1.0F};
  const WallHits hits = meet_revolved(revolve(rays, 0.0), revolved_test_tunnel(50.0, 0.0));
  EXPECT_FLOAT_EQ(hits.x_mm[0], 41.0F);
  EXPECT_FLOAT_EQ(hits.y_mm[0], 30.0F);
  EXPECT_FLOAT_EQ(hits.margin_mm[0], 40.0F);
}

TEST(RevolvedRays, TakeTwentyBytesARay) {
  EXPECT_EQ(revolve(revolved_test_rays(100, 0.0), 0.0).bytes(), 2000U);
}

TEST(RevolvedRays, MeetNothingAlongTheAxis) {
  RayCache rays = revolved_test_rays(1, 0.0);
  rays.direction_x = {1.0F};
  rays.direction_y = {0.0F};
  rays.direction_z = {0.0F};
  EXPECT_EQ(meet_revolved(revolve(rays, 0.0), revolved_test_tunnel(50.0, 0.0)).margin_mm[0],
            kNowhere_mm);
}

TEST(RevolvedRays, AreForSemicylindersWithStraightStripes) {
  TunnelSettings settings;
  EXPECT_TRUE(is_revolved(settings));
  settings.orientation_rad = 0.1;
  EXPECT_FALSE(is_revolved(settings));
  settings = {.shape = TunnelSettings::Shape::kEllipse};
  EXPECT_FALSE(is_revolved(settings));
}

}  // namespace
}  // namespace glint
