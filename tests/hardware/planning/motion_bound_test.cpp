// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/motion_bound.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "tests/hardware/robot/kinematics/arm_poses.h"

namespace glint {
namespace {

using Eigen::Vector3d;

// 2 s + 3 s^2 / 2 = 3.5 at s = 1.
TEST(MotionBound, TheShareWithinAMotionIsItsInverse) {
  const MotionBound bound = {.linear_mm = 2.0, .quadratic_mm = 3.0};
  EXPECT_DOUBLE_EQ(bound.over(1.0), 3.5);
  EXPECT_NEAR(bound.share_within(3.5), 1.0, 1e-12);
  EXPECT_EQ(bound.share_within(-1.0), 0.0);
  EXPECT_TRUE(std::isinf(MotionBound{}.share_within(1.0)));
}

struct Sampled {
  double motion_mm;
  double bound_mm;
};

/// Motion of a body's points relative to a link over a share of a random way, and its bound.
Sampled sampled(std::uint64_t i, const Arm& arm) {
  Rng rng(11, Stream::kTest, i);
  const int link = 1 + static_cast<int>(i % 6);
  const int fixed = static_cast<int>(rng.uniform(0.0, link));
  const std::vector<Vector3d> points = {{rng.uniform(-80.0, 80.0), 40.0, rng.uniform(-80.0, 80.0)},
                                        {10.0, rng.uniform(-80.0, 80.0), -20.0}};
  const JointVector from_rad = random_joints(2 * i);
  const JointVector way_rad = rng.uniform(0.01, 1.0) * (random_joints(2 * i + 1) - from_rad);
  const double share = rng.uniform(0.0, 1.0);
  const auto relative = [&](double s, const Vector3d& point) {
    const LinkFrames frames = arm.frames(from_rad + s * way_rad);
    return Vector3d(frames[static_cast<std::size_t>(fixed)].inverse() *
                    (frames[static_cast<std::size_t>(link)] * point));
  };
  double motion = 0.0;
  for (const Vector3d& point : points) {
    motion = std::max(motion, (relative(share, point) - relative(0.0, point)).norm());
  }
  const MotionHull hull(arm.table(), link, points);
  return {motion, hull.bound(arm.frames(from_rad), way_rad, fixed).over(share)};
}

TEST(MotionHull, NoPointMovesFartherThanTheBound) {
  double closest = 0.0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const ArmModel model = i % 2 == 0 ? ArmModel::kUr3 : ArmModel::kUr5e;
    const Arm arm(model, i % 3 == 0 ? typical_deltas(model) : ArmDeltas{});
    const Sampled one = sampled(i, arm);
    ASSERT_LE(one.motion_mm, one.bound_mm + 1e-9) << i;
    closest = std::max(closest, one.motion_mm / one.bound_mm);
  }
  EXPECT_GT(closest, 0.9) << "a bound that is never near is none";
}

// Joint 1 alone, a point 100 mm from its axis: an arc of 100 mm * 0.2.
TEST(MotionHull, OfOneJointIsTheArc) {
  const Arm arm(ArmModel::kUr3);
  const JointVector still_rad = JointVector::Zero();
  const LinkFrames frames = arm.frames(still_rad);
  const MotionHull hull(
      arm.table(), 1, {frames[1].inverse() * Vector3d(60.0, 80.0, frames[1].translation().z())});
  JointVector way_rad = JointVector::Zero();
  way_rad[0] = -0.2;
  EXPECT_NEAR(hull.bound(frames, way_rad, 0).over(1.0), 20.0, 1e-9);
  EXPECT_EQ(hull.bound(frames, way_rad, 1).over(1.0), 0.0) << "relative to link 1 it rests";
}

}  // namespace
}  // namespace glint
