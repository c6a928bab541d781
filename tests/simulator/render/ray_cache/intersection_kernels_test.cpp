// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/ray_cache/intersection_kernels.h"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

namespace glint {
namespace {

using Sixteen = std::array<double, kLanes>;

/// Rays from (0, 0, 10) that go down and 3 to the side for every 4, onto the plane z = 2.
IntersectionLanes slanted_rays() {
  IntersectionLanes lanes = {};
  const std::array<double, 3> origin_mm = {0.0, 0.0, 10.0};
  alignas(64) Sixteen x = {}, y = {}, z = {};
  x.fill(0.6);
  z.fill(-0.8);
  arrive16(origin_mm.data(), x.data(), y.data(), z.data(), lanes);
  set_plane16(0.0, 0.0, 1.0, 2.0, lanes);
  return lanes;
}

// 8 mm down are 8 / 0.8 = 10 mm along the ray.
TEST(MeetPlanes, GivesTheWayToThePlane) {
  IntersectionLanes lanes = slanted_rays();
  EXPECT_FALSE(intersect_planes16(1e-6, lanes));
  EXPECT_DOUBLE_EQ(lanes.slope[5], -0.8);
  EXPECT_DOUBLE_EQ(lanes.t_mm[5], 10.0);
  lanes.direction_z[15] = 0.0;
  EXPECT_TRUE(intersect_planes16(1e-6, lanes));
}

// Mirrored at z = 2 below x = 6; the next ray starts 0.5 mm above it and rises by 0.8.
TEST(Reflect, MirrorsAtTheNormalAndStartsAboveTheFace) {
  IntersectionLanes lanes = slanted_rays();
  intersect_planes16(1e-6, lanes);
  std::ranges::fill(lanes.normal_z, 1.0);
  orient16(lanes);
  reflect16(0.5, lanes);
  EXPECT_DOUBLE_EQ(lanes.leaving_x[3], 0.6);
  EXPECT_DOUBLE_EQ(lanes.leaving_y[3], 0.0);
  EXPECT_DOUBLE_EQ(lanes.leaving_z[3], 0.8);
  EXPECT_DOUBLE_EQ(lanes.rise[3], 0.8);
  EXPECT_DOUBLE_EQ(lanes.start_x[3], 6.0);
  EXPECT_DOUBLE_EQ(lanes.start_z[3], 2.5);
}

// Faces and normals are turned against the ray; a normal that then still looks away becomes the
// face's.
TEST(Orient, TurnsBothAgainstTheRay) {
  IntersectionLanes lanes = slanted_rays();
  set_plane16(0.0, 0.0, -1.0, -2.0, lanes);  // looks down
  intersect_planes16(1e-6, lanes);
  for (int i = 0; i < kLanes; ++i) {
    lanes.normal_z[i] = i == 0 ? -1.0 : 0.0;
    lanes.normal_x[i] = i == 0 ? 0.0 : -1.0;  // turned: along the ray's sideways part
  }
  orient16(lanes);
  EXPECT_EQ(lanes.face_z[0], 1.0);
  EXPECT_EQ(lanes.normal_z[0], 1.0);
  EXPECT_EQ(lanes.normal_x[1], 0.0);
  EXPECT_EQ(lanes.normal_z[1], 1.0);
}

// The weight is 0.5 * 0.8; it is plain for all lanes until one of the used ones grazes.
TEST(WeighEscapes, TellsWhetherAllLeaveThePart) {
  IntersectionLanes lanes = {};
  alignas(64) std::array<std::int32_t, kLanes> triangle = {};
  alignas(64) std::array<float, kLanes> weight = {};
  for (int i = 0; i < kLanes; ++i) {
    lanes.reflectance[i] = 0.8;
    lanes.rise[i] = i == 9 ? 0.0 : 0.1;
  }
  EXPECT_TRUE(weigh_escapes16(lanes, triangle.data(), 9, 0.5, weight.data()));
  EXPECT_FLOAT_EQ(weight[4], 0.4F);
  EXPECT_FALSE(weigh_escapes16(lanes, triangle.data(), 10, 0.5, weight.data()));
  triangle[2] = -1;
  EXPECT_FALSE(weigh_escapes16(lanes, triangle.data(), 9, 0.5, weight.data()));
}

}  // namespace
}  // namespace glint
