// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/escape_cone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "core/rng.h"
#include "simulator/geometry/bvh.h"
#include "simulator/geometry/part.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// A block of 190 x 44 mm whose top is hollow.
TriangleMesh bowl() {
  return build_part({.length_mm = 190.0,
                     .width_mm = 44.0,
                     .radius_along_mm = -400.0,
                     .radius_across_mm = -60.0})
      .mesh;
}

/// The least that a direction can look along a normal of the cone.
double along_normals(const EscapeCone& cone, const Vector3d& direction) {
  double least = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double component = direction[static_cast<Eigen::Index>(k)];
    least += std::min(cone.low[k] * component, cone.high[k] * component);
  }
  return least;
}

TEST(EscapeCone, RaysThatLeaveABowlInItMeetNothing) {
  const TriangleMesh mesh = bowl();
  const EscapeCone cone = find_escape_cone(mesh);
  ASSERT_FALSE(cone.is_empty);
  const Bvh bvh(mesh);
  Rng rng(7, Stream::kTest, 0);
  int inside = 0;
  int met_outside = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto triangle =
        static_cast<std::size_t>(rng.uniform() * static_cast<double>(mesh.num_triangles()));
    const Vector3d normal = face_normal(mesh, triangle);
    const Vector3d direction = random_direction(rng);
    if (direction.dot(normal) <= 0.0) {
      continue;
    }
    const Vector3d centre =
        (mesh.vertex(triangle, 0) + mesh.vertex(triangle, 1) + mesh.vertex(triangle, 2)) / 3.0;
    const bool is_met =
        static_cast<bool>(bvh.intersect(centre + 1e-3 * normal, direction, 0.0, 1e6));
    if (along_normals(cone, direction) > 0.0) {
      ASSERT_FALSE(is_met) << direction.transpose();
      ++inside;
    } else {
      met_outside += is_met ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(met_outside, 100);
  EXPECT_GT(along_normals(cone, Vector3d(0.6, 0.0, 0.8)), 0.1);
}

TEST(EscapeCone, IsEmptyForPartsThatLookIntoAllDirections) {
  EXPECT_TRUE(
      find_escape_cone(build_part({.shape = PartSettings::Shape::kSpurGear}).mesh).is_empty);
}

// What faces a ray can only be told where there is an inside and an outside.
TEST(EscapeCone, IsEmptyForMeshesThatAreNotSolid) {
  TriangleMesh open = bowl();
  open.triangles.pop_back();
  EXPECT_TRUE(find_escape_cone(open).is_empty);
  TriangleMesh inside_out = bowl();
  for (Triangle& triangle : inside_out.triangles) {
    std::swap(triangle[1], triangle[2]);
  }
  EXPECT_TRUE(find_escape_cone(inside_out).is_empty);
}

}  // namespace
}  // namespace glint
