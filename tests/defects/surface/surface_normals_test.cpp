// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/surface/surface_normals.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "simulator/geometry/part/part.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kCrease_rad = 30.0 * kRadPerDeg;

double largest_normal_error(const TriangleMesh& a, const TriangleMesh& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.num_triangles(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      largest = std::max(largest, (a.normal(i, k) - b.normal(i, k)).norm());
    }
  }
  return largest;
}

TEST(SetNormals, ExactFacesGetTheGradientsTheirPartWasBuiltWith) {
  using Shape = PartSettings::Shape;
  for (const Shape shape : {Shape::kStrip, Shape::kSphereCap, Shape::kCylinder, Shape::kSpurGear}) {
    const Part part = build_part({.shape = shape});
    TriangleMesh mesh = part.mesh;
    mesh.normals.clear();
    mesh.corner_normals.clear();
    set_normals(mesh, part.patches, kCrease_rad);
    EXPECT_LT(largest_normal_error(mesh, part.mesh), 1e-9) << part.name;
  }
}

TEST(SetNormals, FreeFacesAreSmoothedAsMeshesAre) {
  TriangleMesh mesh = sphere_part(5.0).mesh;
  mesh.patch.clear();
  TriangleMesh known = mesh;
  smooth_normals(known, kCrease_rad);
  set_normals(mesh, {}, kCrease_rad);
  EXPECT_LT(largest_normal_error(mesh, known), 1e-12);
  EXPECT_EQ(mesh.normals.size(), known.normals.size());
}

// Each of a cube's 8 corners has 3 normals.
TEST(SetNormals, CreasesOfFreeFacesStaySharp) {
  TriangleMesh mesh = cube_mesh(1.0);
  set_normals(mesh, {}, kCrease_rad);
  EXPECT_EQ(mesh.normals.size(), 24U);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT((mesh.normal(i, k) - face_normal(mesh, i)).norm(), 1e-15);
    }
  }
}

// One hemisphere is free: its corners at the border must not take up the exact faces, and the exact
// ones must stay exact.
TEST(SetNormals, TheBorderBetweenExactAndFreeFacesIsACrease) {
  const Part part = sphere_part(5.0);
  TriangleMesh mesh = part.mesh;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    if (area_vector(mesh, i).x() > 0.0) {
      mesh.patch[i] = -1;
    }
  }
  set_normals(mesh, part.patches, kCrease_rad);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double error = (mesh.normal(i, k) - mesh.vertex(i, k) / 5.0).norm();
      EXPECT_LT(error, mesh.patch[i] >= 0 ? 1e-12 : 0.1);
      EXPECT_NEAR(mesh.normal(i, k).norm(), 1.0, 1e-12);
    }
  }
}

TEST(SetNormals, OpenAndNonManifoldEdgesAreCreases) {
  TriangleMesh mesh;
  mesh.vertices_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0.01}, {0, -1, -0.01}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}};
  set_normals(mesh, {}, kCrease_rad);
  EXPECT_EQ(mesh.normals.size(), 9U);
  EXPECT_LT((mesh.normal(0, 0) - Vector3d::UnitZ()).norm(), 1e-15);
}

// The circle in which the plane x = 3 cuts the sphere of radius 5 has the radius 4.
TEST(OntoPatches, FindsTheNearestPointOfOneOrTwoSurfaces) {
  const Eigen::Matrix3d z_to_x =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), Vector3d::UnitX()).toRotationMatrix();
  const std::vector<ExactPatch> patches = {
      {.shape = SpherePatch{.radius_mm = 5.0}},
      {.shape = PlanePatch{},
       .scene_from_patch = {.rotation = z_to_x, .translation_mm = {3, 0, 0}}}};
  Rng rng(1, Stream::kTest, 0);
  const std::vector<std::int32_t> sphere = {0};
  const std::vector<std::int32_t> both = {0, 1};
  for (int i = 0; i < 1000; ++i) {
    const double angle = rng.uniform(0.0, 2.0 * kPi);
    const Vector3d on(3.0, 4.0 * std::cos(angle), 4.0 * std::sin(angle));
    const Vector3d near = on + random_point(rng, 0.02);
    EXPECT_LT((onto_patches(patches, sphere, near, 0.1) - 5.0 * near.normalized()).norm(), 1e-11);
    const Vector3d edge = onto_patches(patches, both, near, 0.1);
    EXPECT_NEAR(edge.x(), 3.0, 1e-11);
    EXPECT_NEAR(edge.norm(), 5.0, 1e-11);
    EXPECT_LT((edge - near).norm(), 0.05);
  }
}

TEST(OntoPatches, StaysWhereSurfacesDoNotMeetNearby) {
  const std::vector<ExactPatch> patches = {{.shape = SpherePatch{.radius_mm = 5.0}},
                                           {.shape = SpherePatch{.radius_mm = 5.1}}};
  const std::vector<std::int32_t> both = {0, 1};
  const std::vector<std::int32_t> one = {0};
  const Vector3d p(0.0, 5.05, 0.0);
  EXPECT_EQ(onto_patches(patches, both, p, 1.0), p);
  EXPECT_EQ(onto_patches(patches, one, p, 0.01), p);
  EXPECT_EQ(onto_patches(patches, {}, p, 1.0), p);
}

}  // namespace
}  // namespace glint
