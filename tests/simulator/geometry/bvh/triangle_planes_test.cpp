// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/bvh/triangle_planes.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace glint {
namespace {

using Eigen::Vector3d;

/// One triangle through (1, 0, 0), (0, 1, 0) and (0, 0, 1).
TriangleMesh corner_cut() {
  TriangleMesh mesh;
  mesh.vertices_mm = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

// Its normal is (1, 1, 1) / sqrt 3; it is 1 / sqrt 3 away from the origin.
TEST(TrianglePlanes, HoldTheNormalAndTheDistanceFromTheOrigin) {
  const std::vector<TrianglePlane> planes = planes_of(corner_cut());
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_NEAR(planes[0].normal_x, 1.0 / std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(planes[0].normal_y, 1.0 / std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(planes[0].normal_z, 1.0 / std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(planes[0].offset_mm, 1.0 / std::sqrt(3.0), 1e-15);
}

TEST(TrianglePlanes, AreFlatWhereAllThreeNormalsAreTheirs) {
  TriangleMesh mesh = corner_cut();
  const std::vector<TrianglePlane> planes = planes_of(mesh);
  mesh.normals = {Vector3d::Ones().normalized(), Vector3d::UnitZ()};
  mesh.corner_normals = {{0, 0, 0}};
  EXPECT_EQ(find_flat_triangles(mesh, planes)[0], 1);
  mesh.corner_normals = {{0, 0, 1}};
  EXPECT_EQ(find_flat_triangles(mesh, planes)[0], 0);
}

}  // namespace
}  // namespace glint
