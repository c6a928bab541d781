// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/bvh/escape_cone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "core/rng.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"
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
  double minimum = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double component = direction[static_cast<Eigen::Index>(k)];
    minimum += std::min(cone.low[k] * component, cone.high[k] * component);
  }
  return minimum;
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

/// Whether no vertex lies in front of a triangle, one after the other.
bool is_open_plainly(const TriangleMesh& mesh, std::size_t triangle) {
  const Vector3d normal = face_normal(mesh, triangle);
  const double offset_mm = normal.dot(mesh.vertex(triangle, 0));
  return normal.squaredNorm() > 0.0 &&
         std::ranges::none_of(mesh.vertices_mm,
                              [&](const Vector3d& p) { return normal.dot(p) > offset_mm + 1e-7; });
}

/// Number of open triangles, after a comparison of all with the plain way.
int expect_open_as_plainly(const TriangleMesh& mesh) {
  const EscapeCone cone = find_escape_cone(mesh);
  int open = 0;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const bool is_open = !cone.is_open.empty() && cone.is_open[i] != 0;
    EXPECT_EQ(is_open, is_open_plainly(mesh, i)) << i;
    open += is_open ? 1 : 0;
  }
  EXPECT_EQ(cone.is_open.empty(), open == 0);
  return open;
}

TriangleMesh toothed_mesh() {
  return build_part({.shape = PartSettings::Shape::kSpurGear,
                     .gear = {.teeth = 12, .face_width_mm = 8.0},
                     .facets_mm = 0.02})
      .mesh;
}

TEST(EscapeCone, OpenTrianglesAreThoseThatNoVertexLiesInFrontOf) {
  const TriangleMesh gear = toothed_mesh();
  const int open = expect_open_as_plainly(gear);
  EXPECT_GT(open, 100);
  EXPECT_LT(open, static_cast<int>(gear.num_triangles()) - 100);
  EXPECT_GT(expect_open_as_plainly(bowl()), 100);
}

TEST(EscapeCone, TrianglesOfAConvexMeshAreOpen) {
  EXPECT_EQ(expect_open_as_plainly(cube_mesh(3.0)), 12);
  const TriangleMesh sphere = build_part({.shape = PartSettings::Shape::kSphereCap,
                                          .radius_mm = 5.0,
                                          .height_mm = 10.0,
                                          .facets_mm = 0.05})
                                  .mesh;
  const auto num_triangles = static_cast<int>(sphere.num_triangles());
  EXPECT_GT(expect_open_as_plainly(sphere), num_triangles * 9 / 10);  // some edges are hollow
}

// To know them all would take longer than what they save.
TEST(EscapeCone, OpenTrianglesOfAFineMeshMayBeOverlookedButNotInvented) {
  TriangleMesh mesh = sphere_part(20.0).mesh;
  for (Vector3d& vertex : mesh.vertices_mm) {  // a dent
    vertex.z() = vertex.z() > 15.0 ? 30.0 - vertex.z() : vertex.z();
  }
  const EscapeCone cone = find_escape_cone(mesh);
  ASSERT_EQ(cone.is_open.size(), mesh.num_triangles());
  EXPECT_GT(std::ranges::count(cone.is_open, 1), 100);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    EXPECT_TRUE(cone.is_open[i] == 0 || is_open_plainly(mesh, i)) << i;
  }
}

// The side of an open mesh that looks inwards has the rest of it in front.
TEST(EscapeCone, OpenTrianglesAreKnownForMeshesThatAreNotSolid) {
  TriangleMesh mesh = cube_mesh(3.0);
  mesh.triangles.pop_back();
  mesh.triangles.push_back({0, 0, 1});                    // no area
  mesh.triangles.push_back(mesh.triangles[4]);            // twice
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);  // looks inwards
  EXPECT_EQ(expect_open_as_plainly(mesh), 11);
}

// In any pose, from where path tracing starts them.
TEST(EscapeCone, RaysThatLeaveTheFrontOfAnOpenTriangleMeetNothing) {
  const Part gear = build_part({.shape = PartSettings::Shape::kSpurGear,
                                .gear = {.teeth = 12, .face_width_mm = 8.0},
                                .facets_mm = 0.02,
                                .position_mm = {10.0, 20.0, 30.0},
                                .rotation_rad = {0.3, 1.0, 0.2}});
  const TriangleMesh& mesh = gear.mesh;
  const EscapeCone cone = find_escape_cone(mesh);
  const Bvh bvh(mesh);
  constexpr double kStart_mm = 2e-6 * 30.0;
  Rng rng(8, Stream::kTest, 0);
  int left = 0;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Vector3d normal = face_normal(mesh, i);
    const Vector3d direction = random_direction(rng);
    if (cone.is_open[i] == 0 || direction.dot(normal) <= 0.0) {
      continue;
    }
    const Vector3d centre = (mesh.vertex(i, 0) + mesh.vertex(i, 1) + mesh.vertex(i, 2)) / 3.0;
    ASSERT_FALSE(bvh.intersect(centre + kStart_mm * normal, direction, 0.0, 1e6)) << i;
    ++left;
  }
  EXPECT_GT(left, 50);
}

}  // namespace
}  // namespace glint
