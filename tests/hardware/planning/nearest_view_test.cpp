// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/nearest_view.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

using Eigen::Isometry3d;

// Allowed from 37 mm back on: the grid has 45, halved five times towards 0 that is 37.97 or less.
TEST(NearestView, ComesNearTheLimitAlongTheAxis) {
  const auto found = nearest_view(Isometry3d::Identity(), 500.0, [](const Isometry3d& pose) {
    return pose.translation().z() <= -37.0;
  });
  ASSERT_TRUE(found.has_value());
  EXPECT_LE(found->translation().z(), -37.0);
  EXPECT_GT(found->translation().z(), -38.5);
  EXPECT_TRUE(found->linear().isIdentity(1e-12));
}

// The same towards what is looked at, for a view that is too far away: 440 of the grid, then
// halved.
TEST(NearestView, ComesNearerWhereTheViewIsTooFarAway) {
  const auto found = nearest_view(Isometry3d::Identity(), 900.0, [](const Isometry3d& pose) {
    return pose.translation().z() >= 400.0;
  });
  ASSERT_TRUE(found.has_value());
  EXPECT_GE(found->translation().z(), 400.0);
  EXPECT_LT(found->translation().z(), 414.0);
  EXPECT_TRUE(found->linear().isIdentity(1e-12));
}

TEST(NearestView, StaysBeforeWhatIsLookedAt) {
  EXPECT_FALSE(nearest_view(Isometry3d::Identity(), 100.0, [](const Isometry3d& pose) {
    return pose.translation().z() > 86.0;  // tilted at 20 mm: 85
  }));
}

TEST(NearestView, TiltsAboutThePointThatIsLookedAt) {
  const auto found = nearest_view(Isometry3d::Identity(), 100.0, [](const Isometry3d& pose) {
    return pose.linear()(1, 2) < -0.2;  // the view tilted about x
  });
  ASSERT_TRUE(found.has_value());
  const Eigen::Vector3d target = *found * Eigen::Vector3d(0.0, 0.0, 100.0);
  EXPECT_LT((target - Eigen::Vector3d(0.0, 0.0, 100.0)).norm(), 1e-9);
}

TEST(NearestView, FindsNoneWhereNothingIsAllowed) {
  EXPECT_FALSE(
      nearest_view(Isometry3d::Identity(), 100.0, [](const Isometry3d&) { return false; }));
}

}  // namespace
}  // namespace glint
