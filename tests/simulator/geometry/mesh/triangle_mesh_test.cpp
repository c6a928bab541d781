// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh/triangle_mesh.h"

#include <limits>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "simulator/geometry/mesh/mesh_edges.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

// 6 faces of 4 x 4 = 96 mm2, 4^3 = 64 mm3.
TEST(TriangleMesh, CubeHasItsHandWorkedAreaAndVolume) {
  const TriangleMesh mesh = cube_mesh(2.0);
  EXPECT_DOUBLE_EQ(surface_area_mm2(mesh), 96.0);
  EXPECT_DOUBLE_EQ(enclosed_volume_mm3(mesh), 64.0);
  EXPECT_EQ(face_normal(mesh, 0), Vector3d(0, 0, -1));
  EXPECT_EQ(bounding_box(mesh).size_mm(), Vector3d(4, 4, 4));
}

TEST(TriangleMesh, VolumeIsTheSameFarFromTheOrigin) {
  TriangleMesh mesh = cube_mesh(2.0);
  transform(mesh, {.translation_mm = Vector3d(1e6, -2e6, 3e6)});
  EXPECT_NEAR(enclosed_volume_mm3(mesh), 64.0, 1e-6);
}

TEST(TriangleMesh, BoundingBoxOfNothingIsEmpty) {
  EXPECT_TRUE(bounding_box({}).is_empty());
  EXPECT_FALSE(bounding_box(cube_mesh(1.0)).is_empty());
}

// A cube has 12 edges and 6 diagonals.
TEST(MeshEdges, OfACubeAreAllManifoldAndConsistent) {
  const std::vector<MeshEdge> edges = mesh_edges(cube_mesh(1.0));
  ASSERT_EQ(edges.size(), 18U);
  for (const MeshEdge& edge : edges) {
    EXPECT_EQ(edge.num_faces, 2);
    EXPECT_TRUE(edge.is_consistent);
    EXPECT_LT(edge.from, edge.to);
  }
}

TEST(MeshEdges, TellOpenFlippedAndNonManifoldEdgesApart) {
  TriangleMesh mesh;
  mesh.vertices_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};  // both run 0 -> 1
  std::vector<MeshEdge> edges = mesh_edges(mesh);
  ASSERT_EQ(edges.size(), 5U);
  EXPECT_EQ(edges[0].num_faces, 2);
  EXPECT_FALSE(edges[0].is_consistent);
  EXPECT_EQ(edges[1].num_faces, 1);
  EXPECT_EQ(edges[1].triangle_b, -1);
  mesh.triangles.push_back({1, 0, 4});
  EXPECT_EQ(mesh_edges(mesh)[0].num_faces, 3);
}

TEST(SmoothNormals, KeepTheEdgesOfACubeBelowTheCreaseAngle) {
  TriangleMesh mesh = cube_mesh(1.0);
  smooth_normals(mesh, 89.0 * kRadPerDeg);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT((mesh.normal(i, k) - face_normal(mesh, i)).norm(), 1e-15);
    }
  }
  EXPECT_EQ(mesh.normals.size(), 24U);  // 8 corners x 3 faces
}

// Angle weighting makes the corner normal the space diagonal, however the faces are cut.
TEST(SmoothNormals, RoundACubeAboveTheCreaseAngle) {
  TriangleMesh mesh = cube_mesh(1.0);
  smooth_normals(mesh, 91.0 * kRadPerDeg);
  EXPECT_EQ(mesh.normals.size(), 8U);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT((mesh.normal(i, k) - mesh.vertex(i, k) / std::sqrt(3.0)).norm(), 1e-14);
    }
  }
}

TEST(SmoothNormals, OfASpherePointAlongTheRadius) {
  TriangleMesh mesh = sphere_part(20.0).mesh;
  smooth_normals(mesh, 30.0 * kRadPerDeg);
  EXPECT_EQ(mesh.normals.size(), mesh.vertices_mm.size());
  double largest_rad = 0.0;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Vector3d radial = mesh.vertex(i, 0).normalized();
    largest_rad = std::max(largest_rad, (mesh.normal(i, 0) - radial).norm());
  }
  EXPECT_LT(largest_rad, 5e-3);
  EXPECT_GT(largest_rad, 0.0);
}

TEST(SmoothNormals, AreUnitAndFiniteAroundATriangleWithoutArea) {
  TriangleMesh mesh;
  mesh.vertices_mm = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
  smooth_normals(mesh, 0.5);
  for (const Vector3d& normal : mesh.normals) {
    EXPECT_NEAR(normal.norm(), 1.0, 1e-15);
  }
}

TEST(Weld, MergesEqualVerticesAndDropsWhatCollapses) {
  TriangleMesh mesh;
  mesh.vertices_mm = {
      {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}, {0, 1, 0}, {5, 5, 5}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 6}, {0, 3, 6}};
  mesh.patch = {7, 8, 9};
  EXPECT_EQ(weld(mesh), 1U);
  EXPECT_THAT(mesh.vertices_mm,
              ::testing::ElementsAre(
                  Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(2, 0, 0)));
  EXPECT_THAT(mesh.triangles, ::testing::ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  EXPECT_THAT(mesh.patch, ::testing::ElementsAre(7, 8));
}

TEST(Weld, MakesATriangleSoupOfASphereClosedAgain) {
  const TriangleMesh closed = sphere_part(5.0).mesh;
  TriangleMesh soup;
  for (std::size_t i = 0; i < closed.num_triangles(); ++i) {
    const auto first = static_cast<std::int32_t>(soup.vertices_mm.size());
    for (std::size_t k = 0; k < 3; ++k) {
      soup.vertices_mm.push_back(closed.vertex(i, k));
    }
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(weld(soup), 0U);
  EXPECT_EQ(soup.vertices_mm.size(), closed.vertices_mm.size());
  for (const MeshEdge& edge : mesh_edges(soup)) {
    ASSERT_TRUE(edge.is_consistent);
  }
}

TEST(FindFault, NamesTheVertexOrFace) {
  TriangleMesh mesh = cube_mesh(1.0);
  EXPECT_EQ(find_fault(mesh), "");
  mesh.vertices_mm[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(find_fault(mesh), "vertex 3 is not finite");
  mesh = cube_mesh(1.0);
  mesh.triangles[4][1] = 8;
  EXPECT_EQ(find_fault(mesh), "face 4 names vertex 8, but there are only 8");
  mesh.triangles.clear();
  EXPECT_EQ(find_fault(mesh), "it holds no triangle");
}

}  // namespace
}  // namespace glint
