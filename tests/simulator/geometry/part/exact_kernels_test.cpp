// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/part/exact_kernels.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <gtest/gtest.h>

#include "simulator/geometry/part/exact_surface.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

struct KernelCase {
  ExactPatch patch;
  Vector3d on;  ///< a point of the surface, in the scene
};

/// A patch of each shape, with a point of it.
std::vector<KernelCase> kernel_cases(Rng& rng) {
  const double a = rng.uniform(-20, 20);
  const double b = rng.uniform(-15, 15);
  // A point of an involute of base radius 20 at the roll angle T stands at the radius
  // 20 sqrt(1 + T^2) and has turned by T - atan T.
  const double roll = rng.uniform(0.05, 0.9);
  const double hand = rng.uniform() < 0.5 ? -1.0 : 1.0;
  const double start_rad = rng.uniform(-3.0, 3.0);
  const double r = 20.0 * std::sqrt(1.0 + roll * roll);
  const double phi = start_rad + hand * (roll - std::atan(roll));
  const std::vector<std::pair<PatchShape, Vector3d>> shapes = {
      {PlanePatch{}, {a, b, 0.0}},
      {ParaboloidPatch{.radius_along_mm = 800, .radius_across_mm = -80},
       {a, b, -a * a / 1600.0 + b * b / 160.0}},
      {ParaboloidPatch{.radius_across_mm = 60}, {a, b, -b * b / 120.0}},
      {SpherePatch{.radius_mm = 40}, {a, b, std::sqrt(1600.0 - a * a - b * b)}},
      {CylinderPatch{.radius_mm = 25}, {a, b, std::sqrt(625.0 - b * b)}},
      {CylinderPatch{.radius_mm = 25, .is_bore = true}, {a, b, -std::sqrt(625.0 - b * b)}},
      {InvolutePatch{.base_radius_mm = 20, .start_rad = start_rad, .hand = hand},
       {a, r * std::cos(phi), r * std::sin(phi)}}};
  std::vector<KernelCase> cases;
  for (const auto& [shape, on] : shapes) {
    const ExactPatch patch = {.shape = shape, .scene_from_patch = random_pose(rng)};
    cases.push_back({.patch = patch, .on = patch.scene_from_patch * on});
  }
  return cases;
}

/// Sixteen numbers of each kind, and what the kernel makes of them.
struct KernelArrays {
  using Numbers = std::array<double, kExactLanes>;
  alignas(64) Numbers ox = {}, oy = {}, oz = {};
  alignas(64) Numbers dx = {}, dy = {}, dz = {}, t = {};
  alignas(64) Numbers px = {}, py = {}, pz = {}, nx = {}, ny = {}, nz = {}, found = {};

  void set(std::size_t lane, const Vector3d& direction, double start_t) {
    dx[lane] = direction.x();
    dy[lane] = direction.y();
    dz[lane] = direction.z();
    t[lane] = start_t;
  }

  void polish(const ExactPatch& patch, const Vector3d& origin, double max_move_mm) {
    ox.fill(origin.x());
    oy.fill(origin.y());
    oz.fill(origin.z());
    polish16(coefficients_of(patch),
             max_move_mm,
             {.origin_x = ox.data(),
              .origin_y = oy.data(),
              .origin_z = oz.data(),
              .direction_x = dx.data(),
              .direction_y = dy.data(),
              .direction_z = dz.data(),
              .start_t_mm = t.data(),
              .point_x = px.data(),
              .point_y = py.data(),
              .point_z = pz.data(),
              .normal_x = nx.data(),
              .normal_y = ny.data(),
              .normal_z = nz.data(),
              .is_found = found.data()});
  }
};

TEST(Polish16, AgreesWithTheScalarPathOnEveryShape) {
  Rng rng(51, Stream::kTest, 0);
  int found = 0;
  int only_by_kernel = 0;
  for (int round = 0; round < 60; ++round) {
    for (const KernelCase& one : kernel_cases(rng)) {
      const Vector3d origin = one.on + 300.0 * random_direction(rng);
      KernelArrays lanes;
      std::array<Ray, kExactLanes> rays;
      for (std::size_t lane = 0; lane < kExactLanes; ++lane) {
        const Vector3d aim = one.on + random_point(rng, 0.3);
        rays[lane] = {.origin_mm = origin, .direction = (aim - origin).normalized()};
        lanes.set(lane, rays[lane].direction, 300.0 + rng.uniform(-0.3, 0.3));
      }
      lanes.polish(one.patch, origin, 1.0);
      for (std::size_t lane = 0; lane < kExactLanes; ++lane) {
        const auto hit = polish(one.patch, rays[lane], lanes.t[lane], 1.0);
        ASSERT_TRUE(lanes.found[lane] != 0.0 || !hit) << one.patch.shape.index();
        if (lanes.found[lane] != 0.0 && !hit) {  // Newton's method left a root beside a silhouette
          const Vector3d at(lanes.px[lane], lanes.py[lane], lanes.pz[lane]);
          ASSERT_NEAR(implicit_value(one.patch, at, nullptr), 0.0, 1e-11);
          ASSERT_LE((at - origin).norm() - lanes.t[lane], 1.0 + 1e-9);
          ++only_by_kernel;
        }
        if (hit) {
          ++found;
          ASSERT_LT(
              (Vector3d(lanes.px[lane], lanes.py[lane], lanes.pz[lane]) - hit->point_mm).norm(),
              1e-10);
          ASSERT_LT((Vector3d(lanes.nx[lane], lanes.ny[lane], lanes.nz[lane]) - hit->normal).norm(),
                    1e-11);
        }
      }
    }
  }
  EXPECT_GE(found, 3000);
  EXPECT_LE(only_by_kernel, found / 100);
}

// Otherwise a picture would depend on how its pixels are put into packets.
TEST(Polish16, ARayGetsTheSameBitsWhateverStandsBesideIt) {
  Rng rng(52, Stream::kTest, 0);
  for (int round = 0; round < 200; ++round) {
    for (const KernelCase& one : kernel_cases(rng)) {
      const Vector3d origin = one.on + 300.0 * random_direction(rng);
      KernelArrays together;
      for (std::size_t lane = 0; lane < kExactLanes; ++lane) {
        const Vector3d aim = one.on + random_point(rng, 5.0);
        together.set(lane, (aim - origin).normalized(), 300.0 + rng.uniform(-0.5, 0.5));
      }
      KernelArrays alone;
      for (std::size_t lane = 0; lane < kExactLanes; ++lane) {
        alone.set(lane, {together.dx[5], together.dy[5], together.dz[5]}, together.t[5]);
      }
      together.polish(one.patch, origin, 1.0);
      alone.polish(one.patch, origin, 1.0);
      ASSERT_EQ(together.found[5], alone.found[0]);
      if (alone.found[0] != 0.0) {
        ASSERT_EQ(std::bit_cast<std::uint64_t>(together.px[5]),
                  std::bit_cast<std::uint64_t>(alone.px[0]));
        ASSERT_EQ(std::bit_cast<std::uint64_t>(together.nz[5]),
                  std::bit_cast<std::uint64_t>(alone.nz[11]));
      }
    }
  }
}

// However far off it starts, and at the foot of the flank, where the curvature grows.
TEST(Polish16, FindsThePointOfAFlankItWasAimedAtFromAnyStart) {
  constexpr double kBase_mm = 28.0;
  const ExactPatch patch = {.shape = InvolutePatch{.base_radius_mm = kBase_mm}};
  Rng rng(53, Stream::kTest, 0);
  for (int round = 0; round < 2000; ++round) {
    const double roll = round % 4 == 0 ? 0.1 * rng.uniform() : rng.uniform(0.1, 0.7);
    const double c = std::cos(roll);
    const double s = std::sin(roll);
    const Vector3d at(0.0, kBase_mm * (c + roll * s), kBase_mm * (s - roll * c));
    const Vector3d normal(0.0, s, -c);
    const Vector3d across(0.0, c, s);
    const Vector3d arriving =
        (-normal + rng.uniform(-1.5, 1.5) * across + rng.uniform(-0.5, 0.5) * Vector3d::UnitX())
            .normalized();
    KernelArrays lanes;
    for (std::size_t lane = 0; lane < kExactLanes; ++lane) {
      const double off_mm = std::pow(10.0, -7.0 + 0.38 * static_cast<double>(lane));
      lanes.set(lane, arriving, 50.0 + (lane % 2 == 0 ? off_mm : -off_mm));
    }
    lanes.polish(patch, at - 50.0 * arriving, 1.0);
    for (std::size_t lane = 0; lane < kExactLanes; ++lane) {
      if (kBase_mm * roll < 1.0 && lanes.found[lane] == 0.0) {
        continue;  // from within the base circle the root of the flank need not be found
      }
      ASSERT_EQ(lanes.found[lane], 1.0) << roll << ' ' << lane;
      const double off_mm = (Vector3d(lanes.px[lane], lanes.py[lane], lanes.pz[lane]) - at).norm();
      ASSERT_LT(off_mm, kBase_mm * roll < 1.0 ? 1e-9 : 3e-12) << roll << ' ' << lane;
    }
  }
}

TEST(Polish16, GivesUpBeyondTheAllowedMoveAndOnRaysThatNeverMeet) {
  KernelArrays lanes;
  for (std::size_t lane = 0; lane < kExactLanes; ++lane) {
    lanes.set(lane, {0, 0, -1}, lane % 2 == 0 ? 9.9 : 9.7);
  }
  lanes.set(3, {1, 0, 0}, 5.0);
  lanes.polish({.shape = PlanePatch{}}, {0, 0, 10}, 0.2);
  for (std::size_t lane = 0; lane < kExactLanes; ++lane) {
    EXPECT_EQ(lanes.found[lane], lane % 2 == 0 ? 1.0 : 0.0) << lane;
  }
}

// Inside the base circle a flank is a plane through the axis: F = -hand base (phi - start).
TEST(Polish16, AFlankIsRadialInsideItsBaseCircle) {
  KernelArrays lanes;
  for (std::size_t lane = 0; lane < kExactLanes; ++lane) {
    lanes.set(lane, {0, 0, -1}, 9.9);
  }
  lanes.polish({.shape = InvolutePatch{.base_radius_mm = 20}}, {0, 15, 10}, 1.0);
  EXPECT_EQ(lanes.found[0], 1.0);
  EXPECT_NEAR(lanes.pz[0], 0.0, 1e-12);
  EXPECT_NEAR(lanes.nz[0], -1.0, 1e-12);
}

}  // namespace
}  // namespace glint
