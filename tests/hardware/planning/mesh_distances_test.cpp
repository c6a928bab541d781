// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/mesh_distances.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "tests/hardware/planning/plain_distance.h"
#include "tests/hardware/planning/planned_cell.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kAll = 1e6;

double capsule_to_box(const Vector3d& from_mm, const Vector3d& to_mm, double radius_mm) {
  SolidBody box;
  box.mesh = box_mesh(Vector3d::Zero(), Vector3d::Constant(20.0));
  const std::vector<SolidBody> bodies = {capsule_body(from_mm, to_mm, radius_mm), box};
  return MeshDistances(bodies).distance_mm(
             0, Isometry3d::Identity(), 1, Isometry3d::Identity(), kAll) -
         radius_mm;
}

// A cube of half side 10. Above its face: 30 - 10 - 5. Beside its edge: sqrt(20^2 + 20^2) - 2.
// From its corner: |(5, 5, 5)| - 1. Across above an edge, the nearest point within both:
// |(12, 12) - (10, 10)|.
TEST(MeshDistances, OfACapsuleAndABoxByHand) {
  EXPECT_NEAR(capsule_to_box({0, 0, 30}, {0, 50, 30}, 5.0), 15.0, 1e-9);
  EXPECT_NEAR(capsule_to_box({30, 30, -5}, {30, 30, 5}, 2.0), std::sqrt(800.0) - 2.0, 2e-3);
  EXPECT_NEAR(capsule_to_box({15, 15, 15}, {40, 40, 40}, 1.0), std::sqrt(75.0) - 1.0, 2e-3);
  EXPECT_NEAR(capsule_to_box({12, 12, -50}, {12, 12, 50}, 0.0), std::sqrt(8.0), 2e-3);
  EXPECT_LE(capsule_to_box({-50, 0, 0}, {50, 0, 0}, 3.0), -3.0) << "goes through";
}

Vector3d random_point(Rng& rng, double reach_mm) {
  return {rng.uniform(-reach_mm, reach_mm),
          rng.uniform(-reach_mm, reach_mm),
          rng.uniform(-reach_mm, reach_mm)};
}

Isometry3d random_pose(Rng& rng, double reach_mm) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() =
      Eigen::AngleAxisd(rng.uniform(0.0, kPi), random_point(rng, 1.0).normalized()).matrix();
  pose.translation() = random_point(rng, reach_mm);
  return pose;
}

TEST(MeshDistances, AreThoseOfAllPairsOfTriangles) {
  const std::vector<SolidBody> bodies = {{.mesh = ball_mesh({3.0, 2.0, 1.0}, 20.0, 6)},
                                         {.mesh = box_mesh({0.0, 5.0, 0.0}, {10.0, 30.0, 8.0})},
                                         capsule_body({0.0, 0.0, -10.0}, {15.0, 0.0, 20.0}, 0.0)};
  const MeshDistances distances(bodies);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(5, Stream::kTest, i);
    const std::array<Isometry3d, 2> poses = {random_pose(rng, 40.0), random_pose(rng, 40.0)};
    const std::size_t first = i % 3;
    const std::size_t second = (first + 1) % 3;
    double least = kAll;
    const auto corners = [&](std::size_t body, std::size_t k, const Isometry3d& pose) {
      const TriangleMesh& mesh = bodies[body].mesh;
      return Corners{pose * mesh.vertex(k, 0), pose * mesh.vertex(k, 1), pose * mesh.vertex(k, 2)};
    };
    for (std::size_t a = 0; a < bodies[first].mesh.num_triangles(); ++a) {
      for (std::size_t b = 0; b < bodies[second].mesh.num_triangles(); ++b) {
        least = std::min(
            least, triangle_distance(corners(first, a, poses[0]), corners(second, b, poses[1])));
      }
    }
    const double whole = distances.distance_mm(first, poses[0], second, poses[1], kAll);
    EXPECT_NEAR(whole, least, 1e-6) << i;
    EXPECT_NEAR(distances.distance_mm(first, poses[0], second, poses[1], 10.0),
                std::min(10.0, least),
                1e-6);
  }
  EXPECT_EQ(distances.num_queries(), 2000);
}

}  // namespace
}  // namespace glint
