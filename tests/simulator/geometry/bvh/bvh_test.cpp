// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/bvh/bvh.h"

#include <array>
#include <limits>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/geometry/mesh/mesh_edges.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kFar_mm = 1e6;

Part small_gear() {
  PartSettings settings;
  settings.shape = PartSettings::Shape::kSpurGear;
  settings.gear = {.teeth = 12, .module_mm = 2.0, .face_width_mm = 8.0, .bore_mm = 6.0};
  return build_part(settings);
}

/// Moeller and Trumbore in double over all triangles: distance to the nearest hit.
std::optional<double> nearest_by_force(const TriangleMesh& mesh, const Ray& ray) {
  std::optional<double> nearest;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Vector3d e1 = mesh.vertex(i, 1) - mesh.vertex(i, 0);
    const Vector3d e2 = mesh.vertex(i, 2) - mesh.vertex(i, 0);
    const Vector3d p = ray.direction.cross(e2);
    const double det = e1.dot(p);
    const Vector3d s = ray.origin_mm - mesh.vertex(i, 0);
    const double u = s.dot(p) / det;
    const Vector3d q = s.cross(e1);
    const double v = ray.direction.dot(q) / det;
    const double t = e2.dot(q) / det;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && (!nearest || t < *nearest)) {
      nearest = t;
    }
  }
  return nearest;
}

std::vector<Ray> rays_at(double half_mm, int count) {
  Rng rng(11, Stream::kTest, 0);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Vector3d origin = 80.0 * random_direction(rng);
    const Vector3d target = random_point(rng, half_mm);
    rays.push_back({.origin_mm = origin, .direction = (target - origin).normalized()});
  }
  return rays;
}

TEST(Bvh, AgreesWithBruteForceOnAThousandRandomRays) {
  const Part gear = small_gear();
  const Bvh bvh(gear.mesh);
  int hits = 0;
  for (const Ray& ray : rays_at(12.0, 1000)) {
    const std::optional<double> expected_mm = nearest_by_force(gear.mesh, ray);
    const Hit hit = bvh.intersect(ray.origin_mm, ray.direction, 0.0, kFar_mm);
    ASSERT_EQ(static_cast<bool>(hit), expected_mm.has_value());
    ASSERT_EQ(bvh.occluded(ray.origin_mm, ray.direction, 0.0, kFar_mm), expected_mm.has_value());
    if (expected_mm) {
      ++hits;
      const double t_mm = (hit_point(gear.mesh, hit) - ray.origin_mm).dot(ray.direction);
      ASSERT_NEAR(t_mm, *expected_mm, 1e-3);
      ASSERT_NEAR(static_cast<double>(hit.t_mm), *expected_mm, 1e-3);
    }
  }
  EXPECT_GT(hits, 300);
  EXPECT_LT(hits, 1000);
}

TEST(Bvh, PacketsGiveTheSameHitsAsSingleRays) {
  const Part gear = small_gear();
  const Bvh bvh(gear.mesh);
  const std::vector<Ray> rays = rays_at(12.0, 64 * kPacketSize);
  for (std::size_t begin = 0; begin < rays.size(); begin += kPacketSize) {
    RayPacket packet;
    for (std::size_t k = 0; k < kPacketSize; ++k) {
      const Eigen::Vector3f o = rays[begin + k].origin_mm.cast<float>();
      const Eigen::Vector3f d = rays[begin + k].direction.cast<float>();
      packet.origin_x[k] = o.x();
      packet.origin_y[k] = o.y();
      packet.origin_z[k] = o.z();
      packet.direction_x[k] = d.x();
      packet.direction_y[k] = d.y();
      packet.direction_z[k] = d.z();
      packet.t_max[k] = static_cast<float>(kFar_mm);
      packet.valid[k] = k == 5 ? 0 : -1;
    }
    for (const Coherence coherence : {Coherence::kCoherent, Coherence::kIncoherent}) {
      HitPacket hits;
      bvh.intersect16(packet, hits, coherence);
      ASSERT_EQ(hits.triangle[5], -1);
      for (std::size_t k = 0; k < kPacketSize; ++k) {
        const Ray& ray = rays[begin + k];
        const Hit single = bvh.intersect(ray.origin_mm, ray.direction, 0.0, kFar_mm);
        if (k == 5) {
          continue;
        }
        ASSERT_EQ(hits.triangle[k] < 0, !single);
        if (single) {
          ASSERT_NEAR(hits.t_mm[k], single.t_mm, 1e-3F);
        }
      }
    }
  }
}

TEST(Bvh, RespectsTheInterval) {
  const Bvh bvh(cube_mesh(1.0));
  const Vector3d origin(0.1, 0.2, 10.0);
  const Vector3d down(0, 0, -1);
  EXPECT_FLOAT_EQ(bvh.intersect(origin, down, 0.0, 100.0).t_mm, 9.0F);
  EXPECT_FLOAT_EQ(bvh.intersect(origin, down, 9.5, 100.0).t_mm, 11.0F);
  EXPECT_FALSE(bvh.intersect(origin, down, 0.0, 8.9));
  EXPECT_FALSE(bvh.occluded(origin, down, 0.0, 8.9));
  EXPECT_TRUE(bvh.occluded(origin, down, 0.0, 9.1));
  EXPECT_FALSE(bvh.occluded(origin, down, 11.1, 100.0));
}

RayPacket packet_at_vertices(const TriangleMesh& mesh, std::size_t first) {
  RayPacket packet;
  for (std::size_t k = 0; k < kPacketSize; ++k) {
    const Vector3d& p = mesh.vertices_mm[(first + k) % mesh.vertices_mm.size()];
    packet.direction_x[k] = static_cast<float>(p.x());
    packet.direction_y[k] = static_cast<float>(p.y());
    packet.direction_z[k] = static_cast<float>(p.z());
    packet.t_max[k] = static_cast<float>(kFar_mm);
    packet.valid[k] = -1;
  }
  return packet;
}

TEST(Bvh, LetsNoCameraRayOutThroughAVertex) {
  const Part sphere = sphere_part(30.0);
  const Bvh bvh(sphere.mesh);
  for (std::size_t i = 0; i < sphere.mesh.vertices_mm.size(); i += kPacketSize) {
    HitPacket hits;
    bvh.intersect16(packet_at_vertices(sphere.mesh, i), hits, Coherence::kCoherent);
    for (const std::int32_t triangle : hits.triangle) {
      ASSERT_GE(triangle, 0) << "near vertex " << i;
    }
  }
}

TEST(Bvh, LetsNoRayOutOfAClosedSphere) {
  const Part sphere = sphere_part(30.0);
  const Bvh bvh(sphere.mesh);
  Rng rng(12, Stream::kTest, 0);
  for (int i = 0; i < 100000; ++i) {
    const Vector3d origin = 20.0 * rng.uniform() * random_direction(rng);
    ASSERT_TRUE(bvh.intersect(origin, random_direction(rng), 0.0, kFar_mm)) << "ray " << i;
  }
  for (const MeshEdge& edge : mesh_edges(sphere.mesh)) {
    const Vector3d& a = sphere.mesh.vertices_mm[static_cast<std::size_t>(edge.from)];
    const Vector3d& b = sphere.mesh.vertices_mm[static_cast<std::size_t>(edge.to)];
    ASSERT_TRUE(bvh.intersect(Vector3d::Zero(), a + b, 0.0, kFar_mm));
    ASSERT_TRUE(bvh.intersect(Vector3d::Zero(), a, 0.0, kFar_mm));
  }
}

// Corner normals (0,0,1), (0,0,1), (0,1,0) at u = 0.25, v = 0.5: (0, 0.5, 0.5), normalised.
TEST(ShadingNormal, InterpolatesTheHandWorkedCornerNormals) {
  TriangleMesh mesh;
  mesh.vertices_mm = {{0, 0, 0}, {4, 0, 0}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.normals = {{0, 0, 1}, {0, 1, 0}};
  mesh.corner_normals = {{0, 0, 1}};
  const Hit hit = {.triangle = 0, .u = 0.25F, .v = 0.5F};
  EXPECT_EQ(hit_point(mesh, hit), Vector3d(1, 1, 0));
  EXPECT_LT((shading_normal(mesh, hit) - Vector3d(0, 1, 1).normalized()).norm(), 1e-15);
  EXPECT_EQ(geometric_normal(mesh, hit), Vector3d(0, 0, 1));
}

TEST(Bvh, HitsOfAParametricPartPolishOntoItsExactSurface) {
  const Part sphere = sphere_part(30.0);
  const Bvh bvh(sphere.mesh);
  Rng rng(13, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d origin = 100.0 * random_direction(rng);
    const Ray ray = {.origin_mm = origin,
                     .direction = (random_point(rng, 14.0) - origin).normalized()};
    const Hit hit = bvh.intersect(ray.origin_mm, ray.direction, 0.0, kFar_mm);
    ASSERT_TRUE(hit);
    const auto patch = sphere.mesh.patch_of(static_cast<std::size_t>(hit.triangle));
    const auto exact = polish(
        sphere.patches[static_cast<std::size_t>(patch)], ray, static_cast<double>(hit.t_mm), 0.05);
    ASSERT_TRUE(exact.has_value());
    ASSERT_NEAR(exact->point_mm.norm(), 30.0, 1e-12);
    ASSERT_LT((exact->normal - exact->point_mm / 30.0).norm(), 1e-12);
    ASSERT_LT((exact->normal - shading_normal(sphere.mesh, hit)).norm(), 2e-4);
  }
}

TEST(Bvh, KnowsConvexParts) {
  const auto is_convex = [](const PartSettings& settings) {
    return Bvh(build_part(settings).mesh).is_convex();
  };
  EXPECT_TRUE(is_convex({.shape = PartSettings::Shape::kPlate}));
  EXPECT_TRUE(is_convex({.shape = PartSettings::Shape::kStrip}));
  // Its triangles are not: some stand 1 um in front of their neighbours.
  EXPECT_FALSE(is_convex({.shape = PartSettings::Shape::kSphereCap}));
  EXPECT_FALSE(is_convex({.shape = PartSettings::Shape::kStrip, .radius_along_mm = -800.0}));
  EXPECT_FALSE(is_convex({.shape = PartSettings::Shape::kSpurGear}));
}

// A dent of a micrometre in one face of a cube, away from all probes.
TEST(Bvh, APartWithOneSmallHollowIsNotConvex) {
  for (const double depth_mm : {0.0, 1e-3}) {
    TriangleMesh cube = build_part({.shape = PartSettings::Shape::kPlate}).mesh;
    const Triangle top = cube.triangles.back();
    const auto middle = static_cast<std::int32_t>(cube.vertices_mm.size());
    const Vector3d normal = face_normal(cube, cube.num_triangles() - 1);
    const Vector3d centre =
        (cube.vertex(cube.num_triangles() - 1, 0) + cube.vertex(cube.num_triangles() - 1, 1) +
         cube.vertex(cube.num_triangles() - 1, 2)) /
        3.0;
    cube.vertices_mm.emplace_back(centre - depth_mm * normal);
    cube.triangles.pop_back();
    cube.triangles.push_back({top[0], top[1], middle});
    cube.triangles.push_back({top[1], top[2], middle});
    cube.triangles.push_back({top[2], top[0], middle});
    EXPECT_EQ(Bvh(cube).is_convex(), depth_mm == 0.0);
  }
}

TEST(Bvh, TwoConvexBodiesAreNotConvex) {
  TriangleMesh two = build_part({.shape = PartSettings::Shape::kStrip}).mesh;
  const TriangleMesh one = two;
  const auto shift = static_cast<std::int32_t>(one.vertices_mm.size());
  for (const Vector3d& p : one.vertices_mm) {
    two.vertices_mm.emplace_back(p + Vector3d(0, 0, 1e-3));  // no probe tells them apart
  }
  for (const Triangle& t : one.triangles) {
    two.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  }
  EXPECT_TRUE(Bvh(one).is_convex());
  EXPECT_FALSE(Bvh(two).is_convex());
}

TEST(Bvh, AnOpenSheetIsNotConvex) {
  TriangleMesh sheet = build_part({.shape = PartSettings::Shape::kPlate}).mesh;
  sheet.triangles.pop_back();
  EXPECT_FALSE(Bvh(sheet).is_convex());
}

TEST(Bvh, PlanesHoldTheirTriangles) {
  const Part gear = small_gear();
  const Bvh bvh(gear.mesh);
  for (std::size_t i = 0; i < gear.mesh.num_triangles(); ++i) {
    const TrianglePlane& plane = bvh.plane(static_cast<std::int32_t>(i));
    const Vector3d normal(plane.normal_x, plane.normal_y, plane.normal_z);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      ASSERT_NEAR(normal.dot(gear.mesh.vertex(i, corner)), plane.offset_mm, 1e-12);
    }
  }
}

TEST(EmbreeIsa, IsOneOfTheKnownNames) {
  EXPECT_THAT(embree_isa(), ::testing::AnyOf("AVX512", "AVX2", "AVX", "SSE"));
}

TEST(Bvh, PacketsOfShadowRaysAreThoseOfSingleRays) {
  const Part gear = build_part({.shape = PartSettings::Shape::kSpurGear, .facets_mm = 0.1});
  const Bvh bvh(gear.mesh);
  Rng rng(4, Stream::kTest, 0);
  int hidden = 0;
  for (int packet = 0; packet < 200; ++packet) {
    RayPacket rays;
    std::array<bool, kPacketSize> expected = {};
    for (std::size_t k = 0; k < kPacketSize; ++k) {
      const Vector3d from(rng.uniform() * 80.0 - 40.0, rng.uniform() * 80.0 - 40.0, 60.0);
      const Vector3d to(rng.uniform() * 40.0 - 20.0, rng.uniform() * 40.0 - 20.0, 0.0);
      const Eigen::Vector3f o = from.cast<float>();
      const Eigen::Vector3f d = (to - from).normalized().cast<float>();
      rays.origin_x[k] = o.x();
      rays.origin_y[k] = o.y();
      rays.origin_z[k] = o.z();
      rays.direction_x[k] = d.x();
      rays.direction_y[k] = d.y();
      rays.direction_z[k] = d.z();
      rays.t_max[k] = static_cast<float>(20.0 + 60.0 * rng.uniform());
      rays.valid[k] = k % 5 == 4 ? 0 : -1;
      expected[k] =
          bvh.occluded(o.cast<double>(), d.cast<double>(), 0.0, static_cast<double>(rays.t_max[k]));
    }
    bvh.occluded16(rays, Coherence::kIncoherent);
    for (std::size_t k = 0; k < kPacketSize; ++k) {
      ASSERT_EQ(rays.valid[k] != 0, k % 5 != 4 && !expected[k]);
      hidden += expected[k] ? 1 : 0;
    }
  }
  EXPECT_GT(hidden, 500);
  EXPECT_LT(hidden, 3000);
}

}  // namespace
}  // namespace glint
