// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/placement/first_placement.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "hardware/calibration/rotation.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Vector3d scattered(Rng& rng) {
  const double x = rng.normal();
  const double y = rng.normal();
  return {x, y, rng.normal()};
}

/// A pose about 400 mm before a camera at the origin that looks along z.
Isometry3d pose_in_view(Rng& rng) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = rotation_of(3.0 * scattered(rng));
  pose.translation() = Vector3d(0.0, 0.0, 400.0) + 20.0 * scattered(rng);
  return pose;
}

std::vector<PartRay> rays_to(const std::vector<Vector3d>& part,
                             const std::vector<Vector3d>& cameras,
                             const Isometry3d& pose) {
  std::vector<PartRay> rays;
  for (const Vector3d& camera : cameras) {
    for (const Vector3d& point : part) {
      rays.push_back({.part_mm = point,
                      .origin_mm = camera,
                      .direction = (pose * point - camera).normalized()});
    }
  }
  return rays;
}

TEST(FirstPlacements, OneCameraFindsSixPointsInSpaceFromAnyRotation) {
  const std::vector<Vector3d> part = {
      {0, 0, 0}, {60, 0, 0}, {0, 45, 0}, {20, 20, 30}, {50, 40, 10}, {10, 35, -20}};
  Rng rng(3, Stream::kTest, 0);
  for (int trial = 0; trial < 100; ++trial) {
    const Isometry3d truth = pose_in_view(rng);
    const auto found = first_placements(rays_to(part, {Vector3d::Zero()}, truth));
    ASSERT_FALSE(found.empty()) << trial;
    EXPECT_LT(six_of(found[0].inverse() * truth).norm(), 1e-3) << trial;
  }
}

TEST(FirstPlacements, ThreePointsAreEnoughForTwoCameras) {
  const std::vector<Vector3d> part = {{0, 0, 0}, {60, 0, 0}, {0, 45, 0}};
  Rng rng(4, Stream::kTest, 0);
  int found_first = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Isometry3d truth = pose_in_view(rng);
    const auto found =
        first_placements(rays_to(part, {Vector3d::Zero(), Vector3d(250.0, 0.0, 100.0)}, truth));
    found_first += !found.empty() && six_of(found[0].inverse() * truth).norm() < 1e-2 ? 1 : 0;
  }
  EXPECT_EQ(found_first, 100);
}

TEST(FirstPlacements, OfASquareSeenFromAfarBothSolutionsAreTold) {
  const std::vector<Vector3d> part = {{5, 5, 0}, {-5, 5, 0}, {-5, -5, 0}, {5, -5, 0}};
  Isometry3d truth = Isometry3d::Identity();
  truth.linear() = rotation_of({2.6, 0.2, 0.1});
  truth.translation() = Vector3d(0.0, 0.0, 500.0);
  const auto found = first_placements(rays_to(part, {Vector3d::Zero()}, truth));
  ASSERT_GE(found.size(), 2U);
  EXPECT_LT(angle_rad(found[0].linear().transpose() * truth.linear()), 1e-2);
}

TEST(FirstPlacements, NeedThreePointsThatAreNotOnALine) {
  const Isometry3d pose(Eigen::Translation3d(0.0, 0.0, 300.0));
  EXPECT_TRUE(first_placements(rays_to({{0, 0, 0}, {9, 0, 0}}, {Vector3d::Zero()}, pose)).empty());
  EXPECT_TRUE(first_placements(rays_to({{0, 0, 0}, {9, 0, 0}, {4, 0, 0}}, {Vector3d::Zero()}, pose))
                  .empty());
  EXPECT_TRUE(first_placements({}).empty());
}

}  // namespace
}  // namespace glint
