// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/surface/subdivision.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "core/units.h"
#include "defects/surface/surface_normals.h"
#include "simulator/geometry/mesh/mesh_edges.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kSubdivisionCrease_rad = 30.0 * kRadPerDeg;
constexpr double kNoCrease_rad = 2.0 * kPi;

/// Closed, 12 vertices on the unit sphere, 20 faces outwards.
TriangleMesh icosahedron() {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  TriangleMesh mesh;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-g, g}) {
      mesh.vertices_mm.emplace_back(0.0, a, b);
      mesh.vertices_mm.emplace_back(a, b, 0.0);
      mesh.vertices_mm.emplace_back(b, 0.0, a);
    }
  }
  for (std::int32_t i = 0; i < 12; ++i) {
    for (std::int32_t j = i + 1; j < 12; ++j) {
      for (std::int32_t k = j + 1; k < 12; ++k) {
        const auto p = [&](std::int32_t n) {
          return mesh.vertices_mm[static_cast<std::size_t>(n)];
        };
        const auto is_edge = [&](std::int32_t m, std::int32_t n) {
          return std::abs((p(m) - p(n)).norm() - 2.0) < 1e-9;
        };
        if (is_edge(i, j) && is_edge(j, k) && is_edge(k, i)) {
          const bool is_outwards = (p(j) - p(i)).cross(p(k) - p(i)).dot(p(i)) > 0.0;
          mesh.triangles.push_back(is_outwards ? Triangle{i, j, k} : Triangle{i, k, j});
        }
      }
    }
  }
  for (Vector3d& v : mesh.vertices_mm) {
    v.normalize();
  }
  return mesh;
}

void expect_closed_surface(const TriangleMesh& mesh, long long euler) {
  const auto edges = mesh_edges(mesh);
  for (const MeshEdge& edge : edges) {
    ASSERT_TRUE(edge.num_faces == 2 && edge.is_consistent);
  }
  EXPECT_EQ(static_cast<long long>(mesh.vertices_mm.size()) - static_cast<long long>(edges.size()) +
                static_cast<long long>(mesh.num_triangles()),
            euler);
}

std::vector<std::int32_t> numbered(const TriangleMesh& mesh) {
  std::vector<std::int32_t> labels(mesh.num_triangles());
  std::iota(labels.begin(), labels.end(), 0);
  return labels;
}

std::vector<std::int32_t> unlabelled(const TriangleMesh& mesh) {
  std::vector<std::int32_t> zeros(mesh.num_triangles(), 0);
  return zeros;
}

/// One Loop step, with new normals.
Subdivided subdivide_loop(const TriangleMesh& mesh,
                          std::span<const std::int32_t> labels,
                          std::span<const ExactPatch> patches,
                          double crease_rad) {
  Subdivided out = subdivide_midpoint(mesh, labels, patches);
  out.mesh.vertices_mm = loop_places(mesh, labels, out, crease_rad);
  set_normals(out.mesh, patches, crease_rad);
  return out;
}

// A cube of 8 vertices, 18 edges, 12 faces becomes one of 8 + 18 = 26 vertices and 48 faces.
TEST(SubdivideMidpoint, CountsByEulerAndKeepsTheShape) {
  const TriangleMesh cube = cube_mesh(1.5);
  const Subdivided out = subdivide_midpoint(cube, numbered(cube), {});
  EXPECT_EQ(out.mesh.vertices_mm.size(), 26U);
  ASSERT_EQ(out.mesh.num_triangles(), 48U);
  expect_closed_surface(out.mesh, 2);
  EXPECT_DOUBLE_EQ(enclosed_volume_mm3(out.mesh), 27.0);
  for (std::size_t i = 0; i < 48; ++i) {
    EXPECT_EQ(out.labels[i], static_cast<std::int32_t>(i / 4));
    EXPECT_EQ(out.origin[i], static_cast<std::int32_t>(i / 4));
    EXPECT_NEAR((area_vector(out.mesh, i) - 0.25 * area_vector(cube, i / 4)).norm(), 0.0, 1e-15);
  }
}

// A flat face's error on a sphere falls to a quarter with each halving of its edges.
TEST(SubdivideMidpoint, PutsVerticesOfExactFacesOntoTheirSurface) {
  const Part part = sphere_part(5.0);
  const Subdivided out = subdivide_midpoint(part.mesh, unlabelled(part.mesh), part.patches);
  expect_closed_surface(out.mesh, 2);
  for (std::size_t i = 0; i < out.mesh.num_triangles(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(out.mesh.vertex(i, k).norm(), 5.0, 1e-11);
      EXPECT_LT((out.mesh.normal(i, k) - out.mesh.vertex(i, k) / 5.0).norm(), 1e-11);
    }
  }
  const double exact = 4.0 / 3.0 * kPi * 125.0;
  EXPECT_NEAR((exact - enclosed_volume_mm3(part.mesh)) / (exact - enclosed_volume_mm3(out.mesh)),
              4.0,
              0.05);
}

TEST(SubdivideMidpoint, KeepsPartsWithEdgesClosedAndUnfolded) {
  using Shape = PartSettings::Shape;
  for (const Shape shape : {Shape::kStrip, Shape::kCylinder, Shape::kSpurGear}) {
    const Part part = build_part({.shape = shape});
    const Subdivided out = subdivide_midpoint(part.mesh, unlabelled(part.mesh), part.patches);
    EXPECT_EQ(out.mesh.num_triangles(), 4 * part.mesh.num_triangles());
    for (std::size_t i = 0; i < out.mesh.num_triangles(); ++i) {
      ASSERT_GT(area_vector(out.mesh, i).dot(area_vector(part.mesh, i / 4)), 0.0) << part.name;
    }
    for (const MeshEdge& edge : mesh_edges(out.mesh)) {
      ASSERT_TRUE(edge.num_faces == 2 && edge.is_consistent);
    }
  }
}

TEST(SubdivideMidpoint, OpenAndNonManifoldEdgesAreCutOnce) {
  TriangleMesh mesh;
  mesh.vertices_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const Subdivided out = subdivide_midpoint(mesh, unlabelled(mesh), {});
  EXPECT_EQ(out.mesh.vertices_mm.size(), 5U + 7U);
}

// An old vertex of valence 5: c = 3/8 + cos(72 deg) / 4 = 0.452254, weight of each neighbour
// (5/8 - c^2) / 5 = 0.0840932. Its neighbours have the mean 1 / sqrt 5 = 0.447214 of the vertex:
// 1 - 5 * 0.0840932 * (1 - 0.447214) = 0.767572. New vertices: 3/8 of the ends, 1/8 of the others.
TEST(LoopPlaces, MovesTheIcosahedronAsWorkedOutByHand) {
  const TriangleMesh mesh = icosahedron();
  ASSERT_EQ(mesh.num_triangles(), 20U);
  const Subdivided out = subdivide_loop(mesh, unlabelled(mesh), {}, kNoCrease_rad);
  ASSERT_EQ(out.mesh.vertices_mm.size(), 42U);
  expect_closed_surface(out.mesh, 2);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_LT((out.mesh.vertices_mm[i] - 0.767572 * mesh.vertices_mm[i]).norm(), 1e-6);
  }
  const Triangle& t = out.mesh.triangles[0];
  const Triangle& parent = mesh.triangles[0];
  const auto p = [&](std::int32_t v) { return mesh.vertices_mm[static_cast<std::size_t>(v)]; };
  const Vector3d middle = 0.5 * (p(parent[0]) + p(parent[1]));
  // The two opposite corners lie symmetric to the middle: their mean is along it.
  const Vector3d opposite = p(parent[2]).dot(middle) / middle.squaredNorm() * middle;
  EXPECT_LT(
      (out.mesh.vertices_mm[static_cast<std::size_t>(t[1])] - (0.75 * middle + 0.25 * opposite))
          .norm(),
      1e-12);
}

// Volumes shrink towards that of the limit surface, by about a quarter as much each time.
TEST(LoopPlaces, ConvergesToASmoothSurface) {
  TriangleMesh mesh = icosahedron();
  std::vector<double> volumes_mm3 = {enclosed_volume_mm3(mesh)};
  double largest_angle = 0.0;
  for (int level = 0; level < 5; ++level) {
    mesh = subdivide_loop(mesh, unlabelled(mesh), {}, kNoCrease_rad).mesh;
    volumes_mm3.push_back(enclosed_volume_mm3(mesh));
    largest_angle = 0.0;
    for (const MeshEdge& edge : mesh_edges(mesh)) {
      largest_angle = std::max(largest_angle,
                               angle_between_faces(mesh,
                                                   static_cast<std::size_t>(edge.triangle_a),
                                                   static_cast<std::size_t>(edge.triangle_b)));
    }
  }
  EXPECT_LT(largest_angle, 0.05);
  for (std::size_t i = 1; i + 1 < volumes_mm3.size(); ++i) {
    const double step = volumes_mm3[i] - volumes_mm3[i + 1];
    EXPECT_GT(step, 0.0);
    EXPECT_NEAR(step / (volumes_mm3[i - 1] - volumes_mm3[i]), 0.25, 0.07);
  }
  // Nearly a sphere: the radii of the limit surface differ by less than 3 %.
  double minimum = 1e9;
  double maximum = 0.0;
  for (const Vector3d& v : mesh.vertices_mm) {
    minimum = std::min(minimum, v.norm());
    maximum = std::max(maximum, v.norm());
  }
  EXPECT_LT(maximum / minimum, 1.03);
}

TEST(LoopPlaces, ACubeWithCreasesKeepsItsShape) {
  TriangleMesh mesh = cube_mesh(1.0);
  for (int level = 0; level < 3; ++level) {
    mesh = subdivide_loop(mesh, unlabelled(mesh), {}, kSubdivisionCrease_rad).mesh;
  }
  EXPECT_EQ(mesh.num_triangles(), 768U);
  expect_closed_surface(mesh, 2);
  EXPECT_NEAR(enclosed_volume_mm3(mesh), 8.0, 1e-12);
  EXPECT_EQ(mesh.normals.size() % 6, 0U);
  for (const Vector3d& v : mesh.vertices_mm) {
    EXPECT_DOUBLE_EQ(v.cwiseAbs().maxCoeff(), 1.0);
  }
}

// The border of the labelled cap stays where the two-dimensional rule puts it, whatever lies
// beside it: its vertices are 6/8 of themselves and 1/8 of their neighbours along the border.
TEST(LoopPlaces, TheBorderBetweenLabelsIsAnEdge) {
  const TriangleMesh mesh = icosahedron();
  std::vector<std::int32_t> labels = unlabelled(mesh);
  const std::int32_t top = mesh.triangles[0][0];
  std::vector<std::int32_t> rim;
  for (std::size_t i = 0; i < 20; ++i) {
    const Triangle& t = mesh.triangles[i];
    if (std::ranges::find(t, top) != t.end()) {
      labels[i] = 3;
      rim.insert(rim.end(), t.begin(), t.end());
    }
  }
  const Subdivided out = subdivide_loop(mesh, labels, {}, kNoCrease_rad);
  for (const std::int32_t v : rim) {
    if (v == top) {
      continue;
    }
    const Vector3d p = mesh.vertices_mm[static_cast<std::size_t>(v)];
    Vector3d expected = 0.75 * p;
    int neighbours = 0;
    for (std::size_t i = 0; i < 12; ++i) {
      const Vector3d& q = mesh.vertices_mm[i];
      const bool is_on_rim = std::ranges::find(rim, static_cast<std::int32_t>(i)) != rim.end() &&
                             static_cast<std::int32_t>(i) != top;
      if (is_on_rim && (q - p).norm() > 0.1 && (q - p).norm() < 1.2) {
        expected += 0.125 * q;
        ++neighbours;
      }
    }
    ASSERT_EQ(neighbours, 2);
    EXPECT_LT((out.mesh.vertices_mm[static_cast<std::size_t>(v)] - expected).norm(), 1e-12);
  }
}

TEST(LoopPlaces, ExactSurfacesStayExact) {
  const Part part = sphere_part(5.0);
  const Subdivided out =
      subdivide_loop(part.mesh, unlabelled(part.mesh), part.patches, kSubdivisionCrease_rad);
  for (const Vector3d& v : out.mesh.vertices_mm) {
    EXPECT_NEAR(v.norm(), 5.0, 1e-11);
  }
}

}  // namespace
}  // namespace glint
