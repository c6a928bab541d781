// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh/winding_number.h"

#include <utility>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

/// A box of 2 x 4 x 6 mm about the origin.
TriangleMesh box() {
  TriangleMesh mesh = cube_mesh(1.0);
  for (Eigen::Vector3d& vertex_mm : mesh.vertices_mm) {
    vertex_mm = vertex_mm.cwiseProduct(Eigen::Vector3d(1.0, 2.0, 3.0));
  }
  return mesh;
}

TEST(WindingNumber, IsOneInsideAndZeroOutside) {
  const TriangleMesh mesh = box();
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d point_mm(
        rng.uniform(-1.5, 1.5), rng.uniform(-3.0, 3.0), rng.uniform(-4.5, 4.5));
    const bool is_inside =
        (point_mm.cwiseAbs().array() < Eigen::Vector3d(1.0, 2.0, 3.0).array()).all();
    EXPECT_NEAR(winding_number(mesh, point_mm), is_inside ? 1.0 : 0.0, 1e-9);
  }
}

// A cube's face fills a sixth of the directions from its middle.
TEST(WindingNumber, OfAnOpenMeshIsTheShareOfDirections) {
  TriangleMesh mesh = box();
  for (Eigen::Vector3d& vertex : mesh.vertices_mm) {
    vertex = vertex.cwiseSign();
  }
  mesh.triangles.resize(10);
  EXPECT_NEAR(winding_number(mesh, Eigen::Vector3d::Zero()), 5.0 / 6.0, 1e-12);
}

TEST(WindingNumber, OfFacesTurnedInwardsIsNegative) {
  TriangleMesh mesh = box();
  for (Triangle& triangle : mesh.triangles) {
    std::swap(triangle[0], triangle[1]);
  }
  EXPECT_NEAR(winding_number(mesh, Eigen::Vector3d(0.5, 1.0, -2.0)), -1.0, 1e-12);
}

// A hollow body's cavity is outside of it.
TEST(WindingNumber, InACavityIsZero) {
  TriangleMesh mesh = box();
  const TriangleMesh inner = box();
  for (const Eigen::Vector3d& vertex : inner.vertices_mm) {
    mesh.vertices_mm.emplace_back(0.5 * vertex);
  }
  for (const Triangle& triangle : inner.triangles) {
    mesh.triangles.push_back({triangle[1] + 8, triangle[0] + 8, triangle[2] + 8});
  }
  EXPECT_NEAR(winding_number(mesh, Eigen::Vector3d(0.1, 0.1, 0.1)), 0.0, 1e-12);
  EXPECT_NEAR(winding_number(mesh, Eigen::Vector3d(0.75, 0.1, 0.1)), 1.0, 1e-12);
}

}  // namespace
}  // namespace glint
