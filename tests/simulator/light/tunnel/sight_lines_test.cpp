// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/tunnel/sight_lines.h"

#include <array>

#include <gtest/gtest.h>

namespace glint {
namespace {

/// A point in the middle of the tunnel and one 50 mm beside it.
struct TwoPoints {
  std::array<float, 2> x_mm = {0.0F, 0.0F}, y_mm = {0.0F, 50.0F}, z_mm = {0.0F, 0.0F};

  RayBlock block() const {
    return {.origin_x = x_mm.data(),
            .origin_y = y_mm.data(),
            .origin_z = z_mm.data(),
            .count = static_cast<int>(x_mm.size())};
  }
};

const Eigen::Vector3d kAbove_mm(0.0, 0.0, 600.0);

/// A semicylinder of 100 mm, open for 20 mm at its top.
TunnelSettings slotted() {
  return {.radius_mm = 100.0, .length_mm = 600.0, .slot_mm = 20.0};
}

// (50 - 50 t)^2 + (600 t)^2 = 100^2 at t = 0.150901: y = 42.455, z = 90.540. From there to the
// slot's edge at y = 10 are 32.455 mm, to the tunnel's end 300.
TEST(SightLines, TellWhereTheyCrossTheWallAndHowFarItsEdgesAre) {
  const TwoPoints points;
  const SightLines lines = sight_lines(Tunnel(slotted()), points.block(), kAbove_mm);
  EXPECT_EQ(lines.occluded.at(0), 0.0F);
  EXPECT_EQ(lines.occluded.at(1), 1.0F);
  EXPECT_NEAR(lines.x_mm.at(1), 0.0F, 1e-3F);
  EXPECT_NEAR(lines.y_mm.at(1), 42.455F, 1e-3F);
  EXPECT_NEAR(lines.z_mm.at(1), 90.540F, 1e-3F);
  EXPECT_NEAR(lines.to_edge_mm.at(1), 32.455F, 1e-3F);
  EXPECT_NEAR(lines.to_end_mm.at(1), 300.0F, 1e-3F);
}

}  // namespace
}  // namespace glint
