// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/surface/surface_sampling.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "simulator/geometry/mesh_file/mesh_io.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kAnywhere_mm = std::numeric_limits<double>::infinity();

/// Triangles of all sizes at random places; every tenth has no area.
TriangleMesh random_triangles(std::uint64_t seed, int count) {
  Rng rng(seed, Stream::kTest, 2);
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vector3d centre = random_point(rng, 50.0);
    const double size_mm = std::exp(rng.uniform(-4.0, 3.0));
    const Vector3d a = centre + random_point(rng, size_mm);
    const Vector3d b = centre + random_point(rng, size_mm);
    const Vector3d c = i % 10 == 9 ? a : Vector3d(centre + random_point(rng, size_mm));
    const auto first = static_cast<std::int32_t>(mesh.vertices_mm.size());
    mesh.vertices_mm.insert(mesh.vertices_mm.end(), {a, b, c});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// Closest point of a triangle by cases over its corners, edges and face.
/// Source: C. Ericson, "Real-time collision detection", 2004, section 5.1.5.
Vector3d nearest_by_cases(const TriangleMesh& mesh, std::size_t i, const Vector3d& p) {
  const Vector3d& a = mesh.vertex(i, 0);
  const Vector3d ab = mesh.vertex(i, 1) - a;
  const Vector3d ac = mesh.vertex(i, 2) - a;
  const double d1 = ab.dot(p - a);
  const double d2 = ac.dot(p - a);
  const double d3 = ab.dot(p - a - ab);
  const double d4 = ac.dot(p - a - ab);
  const double d5 = ab.dot(p - a - ac);
  const double d6 = ac.dot(p - a - ac);
  if (d1 <= 0.0 && d2 <= 0.0) {
    return a;
  }
  if (d3 >= 0.0 && d4 <= d3) {
    return a + ab;
  }
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    return a + d1 / (d1 - d3) * ab;
  }
  if (d6 >= 0.0 && d5 <= d6) {
    return a + ac;
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    return a + d2 / (d2 - d6) * ac;
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return a + ab + (d4 - d3) / (d4 - d3 + d5 - d6) * (ac - ab);
  }
  return a + vb / (va + vb + vc) * ab + vc / (va + vb + vc) * ac;
}

/// Sum over cells of (seen - expected)^2 / expected.
double chi_square(const std::vector<int>& seen, const std::vector<double>& shares, int total) {
  double sum = 0.0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const double expected = shares[i] * total;
    sum += (seen[i] - expected) * (seen[i] - expected) / expected;
  }
  return sum;
}

TEST(BvhNearest, AgreesWithBruteForceOnRandomMeshes) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TriangleMesh mesh = random_triangles(seed, 300);
    const Bvh bvh(mesh);
    Rng rng(seed, Stream::kTest, 3);
    for (int k = 0; k < 500; ++k) {
      const Vector3d p = random_point(rng, k % 2 == 0 ? 60.0 : 300.0);
      double min_distance_mm = kAnywhere_mm;
      for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
        const double distance_mm = (nearest_by_cases(mesh, i, p) - p).norm();
        min_distance_mm =
            std::isnan(distance_mm) ? min_distance_mm : std::min(min_distance_mm, distance_mm);
      }
      const auto nearest = bvh.nearest(mesh, p, kAnywhere_mm);
      ASSERT_TRUE(nearest.has_value());
      EXPECT_NEAR(nearest->distance_mm, min_distance_mm, 1e-11);
      EXPECT_EQ((nearest->point_mm - p).norm(), nearest->distance_mm);
    }
  }
}

// 3 mm above the top face of a cube of half 5 mm: within 3.0001 mm, not within 2.9999 mm.
TEST(BvhNearest, KeepsToTheLargestDistance) {
  const TriangleMesh cube = cube_mesh(5.0);
  const Bvh bvh(cube);
  EXPECT_TRUE(bvh.nearest(cube, {1.0, 2.0, 8.0}, 3.0001).has_value());
  EXPECT_TRUE(bvh.nearest(cube, {1.0, 2.0, 8.0}, 3.0).has_value());
  EXPECT_FALSE(bvh.nearest(cube, {1.0, 2.0, 8.0}, 2.9999).has_value());
}

// The corner (5, 5, 5) belongs to triangles 3, 6, 7 and 10, ... of the cube: the lowest is told.
TEST(BvhNearest, AtACornerTheLowestTriangleIsTold) {
  const TriangleMesh cube = cube_mesh(5.0);
  std::int32_t lowest = 0;
  const auto has_corner = [&](std::int32_t i) {
    return std::ranges::count(cube.triangles[static_cast<std::size_t>(i)], 7) > 0;
  };
  while (!has_corner(lowest)) {
    ++lowest;
  }
  const auto nearest = Bvh(cube).nearest(cube, {6.0, 6.0, 6.0}, 10.0);
  ASSERT_TRUE(nearest.has_value());
  EXPECT_EQ(nearest->triangle, lowest);
  EXPECT_NEAR(nearest->distance_mm, std::sqrt(3.0), 1e-15);
}

// 270 triangles with area: chi-square with 269 degrees of freedom has mean 269 and standard
// deviation sqrt(2 * 269) = 23.2; below 269 + 4 * 23.2 = 362.
TEST(AreaSampler, ChoosesTrianglesInProportionToTheirArea) {
  const TriangleMesh mesh = random_triangles(7, 300);
  const AreaSampler sampler(mesh);
  EXPECT_NEAR(sampler.area_mm2(), surface_area_mm2(mesh), 1e-9);
  constexpr int kDraws = 400000;
  std::vector<int> seen(mesh.num_triangles(), 0);
  Rng rng(8, Stream::kTest, 0);
  for (int i = 0; i < kDraws; ++i) {
    ++seen[static_cast<std::size_t>(sampler.draw(mesh, rng).triangle)];
  }
  std::vector<int> seen_with_area;
  std::vector<double> shares;
  std::vector<double> equal;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (i % 10 == 9) {
      EXPECT_EQ(seen[i], 0);
      continue;
    }
    seen_with_area.push_back(seen[i]);
    shares.push_back(area_vector(mesh, i).norm() / sampler.area_mm2());
    equal.push_back(1.0 / 270.0);
  }
  EXPECT_LT(chi_square(seen_with_area, shares, kDraws), 362.0);
  EXPECT_GT(chi_square(seen_with_area, equal, kDraws), 1e5);  // the test tells a wrong rule
}

// Halving all edges cuts a triangle into four of equal area; 3 degrees of freedom: 16.3 is exceeded
// once in 1000. Weights without the square root crowd at corner 0.
TEST(AreaSampler, IsUniformWithinATriangle) {
  TriangleMesh mesh;
  mesh.vertices_mm = {{0.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, {1.0, 3.0, 0.0}};
  mesh.triangles = {{0, 1, 2}};
  const AreaSampler sampler(mesh, {0});
  constexpr int kDraws = 40000;
  std::vector<int> seen(4, 0);
  std::vector<int> crowded(4, 0);
  Rng rng(9, Stream::kTest, 0);
  for (int i = 0; i < kDraws; ++i) {
    const Vector3d p = sampler.draw(mesh, rng).point_mm;
    const double c = p.y() / 3.0;
    const double b = (p.x() - c) / 4.0;
    const double a = 1.0 - b - c;
    EXPECT_GE(std::min({a, b, c}), -1e-12);
    const auto cell_of = [](double x, double y, double z) {
      return x > 0.5 ? 0U : y > 0.5 ? 1U : z > 0.5 ? 2U : 3U;
    };
    ++seen[cell_of(a, b, c)];
    const double s = (1.0 - a) * (1.0 - a);  // as if s were drawn without its square root
    ++crowded[cell_of(1.0 - s, s * 0.5, s * 0.5)];
  }
  EXPECT_LT(chi_square(seen, {0.25, 0.25, 0.25, 0.25}, kDraws), 16.3);
  EXPECT_GT(chi_square(crowded, {0.25, 0.25, 0.25, 0.25}, kDraws), 1000.0);
}

TEST(AreaSampler, DrawsOnlyFromWhatIsAllowed) {
  const TriangleMesh cube = cube_mesh(5.0);
  const AreaSampler some(cube, {2, 3, 11});
  const SurfacePiece piece = {
      .triangle = 6, .corners_mm = {Vector3d(0, 5, 0), Vector3d(1, 5, 0), Vector3d(0, 5, 1)}};
  const AreaSampler pieces({piece});
  EXPECT_DOUBLE_EQ(pieces.area_mm2(), 0.5);
  Rng rng(10, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const std::int32_t triangle = some.draw(cube, rng).triangle;
    EXPECT_TRUE(triangle == 2 || triangle == 3 || triangle == 11);
    const auto sample = pieces.draw(cube, rng);
    EXPECT_EQ(sample.triangle, 6);
    EXPECT_LE(sample.point_mm.x() + sample.point_mm.z(), 1.0 + 1e-12);
  }
}

TEST(OntoPatch, LandsOnTheSurfaceWithItsNormal) {
  const Part sphere = sphere_part(20.0);
  Rng rng(11, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d n = random_direction(rng);
    const Vector3d p = (20.0 + rng.uniform(-0.05, 0.05)) * n;
    const auto on = onto_patch(sphere.patches[0], p, 0.1);
    ASSERT_TRUE(on.has_value());
    EXPECT_LT((on->point_mm - 20.0 * n).norm(), 1e-11);
    EXPECT_LT((on->normal - n).norm(), 1e-12);
  }
  EXPECT_FALSE(onto_patch(sphere.patches[0], {20.2, 0.0, 0.0}, 0.1).has_value());
}

/// A plane of 1 mm squares whose vertices jump up and down at random.
Part rough_plane() {
  constexpr int kCells = 40;
  Rng rng(12, Stream::kTest, 0);
  Part part;
  for (int y = 0; y <= kCells; ++y) {
    for (int x = 0; x <= kCells; ++x) {
      part.mesh.vertices_mm.emplace_back(x, y, rng.uniform(-0.1, 0.1));
    }
  }
  for (int y = 0; y < kCells; ++y) {
    for (int x = 0; x < kCells; ++x) {
      const std::int32_t i = y * (kCells + 1) + x;
      part.mesh.triangles.push_back({i, i + 1, i + kCells + 2});
      part.mesh.triangles.push_back({i, i + kCells + 2, i + kCells + 1});
    }
  }
  smooth_normals(part.mesh, 0.0);  // every facet has its own normal
  return part;
}

TEST(FootprintNormal, AveragesRoughFacets) {
  const Part part = rough_plane();
  const Bvh bvh(part.mesh);
  Rng rng(13, Stream::kTest, 0);
  double facet_rad = 0.0;
  double wide_rad = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Vector3d p(rng.uniform(10.0, 30.0), rng.uniform(10.0, 30.0), 0.0);
    const auto at = bvh.nearest(part.mesh, p, 1.0);
    const SurfacePoint point = smooth_point(part, at->triangle, at->point_mm);
    const auto tilt = [](const Vector3d& n) { return std::acos(std::min(1.0, n.z())); };
    facet_rad += tilt(footprint_normal(part, bvh, point, 1e-3)) / 100.0;
    wide_rad += tilt(footprint_normal(part, bvh, point, 5.0)) / 100.0;
  }
  EXPECT_GT(facet_rad, 0.07);
  EXPECT_LT(wide_rad, 0.03);
}

// 1 mm from the edge of a cube a footprint of 4 mm reaches over it, and still looks straight up.
TEST(FootprintNormal, LeavesOutWhatLiesBeyondASharpEdge) {
  Part part;
  part.mesh = cube_mesh(5.0);
  smooth_normals(part.mesh, 0.5);
  const Bvh bvh(part.mesh);
  const SurfacePoint at = {.point_mm = {4.0, 0.0, 5.0}, .triangle = 2};
  EXPECT_LT((footprint_normal(part, bvh, at, 4.0) - Vector3d::UnitZ()).norm(), 1e-12);
}

std::filesystem::path coloured_ply(const std::string& properties, const std::string& faces) {
  std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "colours.ply";
  write_file(path,
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
             "property float z\nelement face 3\nproperty list uchar int vertex_indices\n" +
                 properties + "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + faces);
  return path;
}

// A square is two triangles; the second face is a line and is dropped, as read_mesh() drops it.
TEST(ReadFaceColours, GivesOneForEachTriangleOfTheMesh) {
  const auto path = coloured_ply("property uchar red\nproperty uchar green\nproperty uchar blue\n",
                                 "4 0 1 2 3 255 0 7\n3 0 1 1 9 9 9\n3 0 2 3 0 1 0\n");
  const auto colours = read_face_colours(path);
  using Colour = std::array<std::uint8_t, 3>;
  EXPECT_THAT(colours,
              ::testing::ElementsAre(Colour{255, 0, 7}, Colour{255, 0, 7}, Colour{0, 1, 0}));
  EXPECT_EQ(colours.size(), read_mesh(path).num_triangles());
}

TEST(ReadFaceColours, ReadsSharesAndRefusesFilesWithoutColours) {
  const auto path = coloured_ply("property float blue\nproperty float red\nproperty float green\n",
                                 "3 0 1 2 1 0.5 0\n3 0 1 3 2 -1 0\n3 0 2 3 0 0 0.2\n");
  using Colour = std::array<std::uint8_t, 3>;
  EXPECT_THAT(read_face_colours(path),
              ::testing::ElementsAre(Colour{128, 0, 255}, Colour{0, 0, 255}, Colour{0, 51, 0}));
  const auto plain = coloured_ply("property uchar red\n", "3 0 1 2 1\n3 0 1 3 2\n3 0 2 3 3\n");
  EXPECT_THAT([&] { read_face_colours(plain); },
              ::testing::ThrowsMessage<ConfigError>(::testing::HasSubstr("no colours")));
  const std::filesystem::path other = std::filesystem::path(::testing::TempDir()) / "no_ply.off";
  write_file(other, "OFF\n");
  EXPECT_THAT([&] { read_face_colours(other); },
              ::testing::ThrowsMessage<ConfigError>(::testing::HasSubstr("is no PLY file")));
}

}  // namespace
}  // namespace glint
