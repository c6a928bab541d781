// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "core/rng.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// A box of size 2 whose top has a box-shaped knob of size 1 and height 1 in its middle.
TriangleMesh box_with_knob() {
  TriangleMesh mesh;
  const auto quad = [&mesh](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const auto first = static_cast<std::int32_t>(mesh.vertices_mm.size());
    for (const Vector3d& p : {a, b, c, Vector3d(a + c - b)}) {
      mesh.vertices_mm.push_back(p);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  };
  const auto box = [&](double half, double low, double high) {
    quad({-half, -half, high}, {half, -half, high}, {half, half, high});
    quad({-half, -half, low}, {-half, half, low}, {half, half, low});
    for (int turn = 0; turn < 4; ++turn) {
      const Eigen::AngleAxisd to(0.5 * turn * 3.14159265358979323846, Vector3d::UnitZ());
      quad(to * Vector3d(half, -half, low),
           to * Vector3d(half, half, low),
           to * Vector3d(half, half, high));
    }
  };
  box(1.0, 0.0, 2.0);
  box(0.5, 2.0, 3.0);
  return mesh;
}

TEST(UnoccludedFaces, AreTheFlatFacesNothingRisesAbove) {
  const TriangleMesh mesh = box_with_knob();
  const UnoccludedFaces sides = find_unoccluded_faces(mesh, 1e-6);
  EXPECT_EQ(sides.normals.size(), 6U);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Vector3d centre = (mesh.vertex(i, 0) + mesh.vertex(i, 1) + mesh.vertex(i, 2)) / 3.0;
    const Vector3d normal = face_normal(mesh, i);
    const bool is_big_top = normal.z() > 0.5 && centre.z() < 2.5;
    const bool is_knob_side = std::abs(normal.z()) < 0.5 && centre.z() > 2.0;
    const bool is_knob_base = normal.z() < -0.5 && centre.z() > 1.0;
    const bool is_open = !is_big_top && !is_knob_side && !is_knob_base;
    ASSERT_EQ(sides.of_triangle[i] >= 0, is_open) << i;
    if (is_open) {
      EXPECT_GT(sides.normals[static_cast<std::size_t>(sides.of_triangle[i])].dot(normal), 0.9999);
    }
  }
}

/// A rotated gear: no ray that leaves an open face outwards is in the way of the part.
TEST(UnoccludedFaces, LetEveryRayOut) {
  const Part gear = build_part({.shape = PartSettings::Shape::kSpurGear,
                                .facets_mm = 0.05,
                                .position_mm = {10.0, 20.0, 30.0},
                                .rotation_rad = {0.3, 1.0, 0.2}});
  const TriangleMesh& mesh = gear.mesh;
  const Bvh bvh(mesh);
  const UnoccludedFaces& sides = bvh.unoccluded_faces(mesh);
  double largest_mm = 0.0;
  for (const Vector3d& vertex : mesh.vertices_mm) {
    largest_mm = std::max(largest_mm, vertex.cwiseAbs().maxCoeff());
  }
  Rng rng(9, Stream::kTest, 0);
  int rays = 0;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    if (sides.of_triangle[i] < 0) {
      continue;
    }
    const Vector3d& up = sides.normals[static_cast<std::size_t>(sides.of_triangle[i])];
    const Vector3d centre = (mesh.vertex(i, 0) + mesh.vertex(i, 1) + mesh.vertex(i, 2)) / 3.0;
    for (int k = 0; k < 4; ++k) {
      Vector3d d(2.0 * rng.uniform() - 1.0, 2.0 * rng.uniform() - 1.0, 2.0 * rng.uniform() - 1.0);
      d = d.normalized();
      d -= std::min(0.0, 2.0 * d.dot(up)) * up;  // upwards
      d += 1e-3 * up;
      EXPECT_FALSE(bvh.occluded(centre + 2e-6 * largest_mm * up, d, 0.0, 1e4)) << i;
      ++rays;
    }
  }
  EXPECT_GE(rays, 1000);
}

TEST(UnoccludedFaces, OfABallAreNone) {
  const Part ball = build_part({.shape = PartSettings::Shape::kSphereCap,
                                .radius_mm = 10.0,
                                .height_mm = 20.0,
                                .facets_mm = 0.05});
  EXPECT_TRUE(find_unoccluded_faces(ball.mesh, 1e-6).empty());
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
