// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/part/mesh_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kCrease_rad = 30.0 * kRadPerDeg;

Part part_of(TriangleMesh mesh) {
  Part part;
  part.name = "test";
  part.mesh = std::move(mesh);
  part.box_in_part_mm = bounding_box(part.mesh);
  part.is_from_file = true;
  return part;
}

/// An open band of flat facets around x, each turned by that angle against the next.
TriangleMesh band(int facets, double step_rad) {
  TriangleMesh mesh;
  for (int i = 0; i <= facets; ++i) {
    const double angle = i * step_rad;
    mesh.vertices_mm.emplace_back(0.0, 100.0 * std::cos(angle), 100.0 * std::sin(angle));
    mesh.vertices_mm.emplace_back(50.0, 100.0 * std::cos(angle), 100.0 * std::sin(angle));
  }
  for (std::int32_t i = 0; i < facets; ++i) {
    mesh.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 3});
    mesh.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 1});
  }
  return mesh;
}

TEST(MeshReport, OfACubeHasTheHandWorkedNumbers) {
  const MeshReport r = report(part_of(cube_mesh(5.0)), 1e-3, kCrease_rad);
  EXPECT_EQ(r.size_mm, Vector3d(10, 10, 10));
  EXPECT_DOUBLE_EQ(r.area_mm2, 600.0);
  EXPECT_DOUBLE_EQ(r.volume_mm3, 1000.0);
  EXPECT_EQ(r.num_triangles, 12U);
  EXPECT_EQ(r.num_vertices, 8U);
  EXPECT_TRUE(r.is_watertight);
  EXPECT_FALSE(r.is_inside_out);
  EXPECT_EQ(r.largest_facet_angle_rad, 0.0);  // its edges are meant to be sharp
  EXPECT_TRUE(r.is_fine_enough);
  EXPECT_THAT(r.warnings, IsEmpty());
  EXPECT_EQ(r.action, "");
}

TEST(MeshReport, CountsHolesFlippedFacesAndFacesWithoutArea) {
  TriangleMesh mesh = cube_mesh(5.0);
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);  // its three edges are now flipped
  mesh.triangles.pop_back();                              // a hole of three edges
  mesh.vertices_mm.emplace_back(50, 0, 0);
  mesh.vertices_mm.emplace_back(60, 0, 0);
  mesh.vertices_mm.emplace_back(70, 0, 0);
  mesh.triangles.push_back({8, 9, 10});
  const MeshReport r = report(part_of(mesh), 1e-3, kCrease_rad);
  EXPECT_EQ(r.flipped_edges, 3U);
  EXPECT_EQ(r.open_edges, 6U);
  EXPECT_EQ(r.degenerate_triangles, 1U);
  EXPECT_FALSE(r.is_watertight);
  EXPECT_EQ(r.volume_mm3, 0.0);
  EXPECT_THAT(r.warnings,
              ElementsAre(HasSubstr("6 open edges"),
                          HasSubstr("3 edges whose two faces"),
                          HasSubstr("1 triangles without area")));
}

TEST(MeshReport, SeesNonManifoldEdgesAndInsideOutMeshes) {
  TriangleMesh mesh = cube_mesh(5.0);
  mesh.vertices_mm.emplace_back(0, 0, 20);
  mesh.triangles.push_back({4, 5, 8});
  EXPECT_EQ(report(part_of(mesh), 1e-3, kCrease_rad).nonmanifold_edges, 1U);
  mesh = cube_mesh(5.0);
  for (Triangle& triangle : mesh.triangles) {
    std::swap(triangle[0], triangle[1]);
  }
  const MeshReport r = report(part_of(mesh), 1e-3, kCrease_rad);
  EXPECT_TRUE(r.is_inside_out);
  EXPECT_DOUBLE_EQ(r.volume_mm3, 1000.0);
}

// 1 mrad between facets against a slope of 5 mrad: 0.5 mrad allowed, so twice too coarse.
TEST(MeshReport, CallsFacetsADefectAboveATenthOfTheSlope) {
  const MeshReport coarse = report(part_of(band(100, 1e-3)), 5e-3, kCrease_rad);
  EXPECT_NEAR(coarse.largest_facet_angle_rad, 1e-3, 1e-9);
  EXPECT_NEAR(coarse.facet_angle_95_rad, 1e-3, 1e-9);
  EXPECT_FALSE(coarse.is_fine_enough);
  EXPECT_THAT(coarse.verdict, HasSubstr("show up as defects"));
  EXPECT_THAT(coarse.action, HasSubstr("edges 2 times shorter"));
  EXPECT_THAT(coarse.action, HasSubstr("steeper than 10 mrad"));
  const MeshReport fine = report(part_of(band(100, 1e-3)), 11e-3, kCrease_rad);
  EXPECT_TRUE(fine.is_fine_enough);
  EXPECT_THAT(fine.verdict, HasSubstr("fine enough"));
}

// 30 mrad between facets against 2 mrad: 150 times too coarse, and 300 mrad is the slope to trust;
// at 0.3 rad between facets no slope of a surface is left to trust.
TEST(MeshReport, AdvisesNothingThatCannotBeDone) {
  const MeshReport coarse = report(part_of(band(60, 30e-3)), 2e-3, kCrease_rad);
  EXPECT_THAT(coarse.action, Not(HasSubstr("times shorter")));
  EXPECT_THAT(coarse.action, HasSubstr("steeper than 300 mrad (17 deg)"));
  const MeshReport coarsest = report(part_of(band(12, 0.3)), 2e-3, kCrease_rad);
  EXPECT_THAT(coarsest.action, HasSubstr("parametric part"));
  EXPECT_THAT(coarsest.action, HasSubstr("no defect can be told from its facets"));
  for (const MeshReport& told : {coarse, coarsest}) {
    EXPECT_THAT(told.verdict + told.action, Not(HasSubstr("e+")));
  }
}

TEST(MeshReport, LeavesOutEdgesSharperThanTheCrease) {
  const MeshReport r = report(part_of(band(6, 0.6)), 1e-3, kCrease_rad);
  EXPECT_EQ(r.largest_facet_angle_rad, 0.0);
}

TEST(MeshReport, FindsAParametricPartExact) {
  const MeshReport r = report(build_part({}), 1e-4, kCrease_rad);
  EXPECT_TRUE(r.has_exact_surface);
  EXPECT_TRUE(r.is_fine_enough);
  EXPECT_TRUE(r.is_watertight);
  EXPECT_THAT(r.verdict, HasSubstr("exact"));
  EXPECT_EQ(r.name, "strip");
}

}  // namespace
}  // namespace glint
