// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/path_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "hardware/robot/kinematics/link_shapes.h"
#include "hardware/robot/trapezoid.h"
#include "tests/hardware/robot/cell_robot_settings.h"

namespace glint {
namespace {

using Problem = CheckedMotion::Problem;

ArmWithTool test_arm(const MotionLimits& limits = test_limits()) {
  return arm_with_tool(test_robot(ArmModel::kUr3e), limits);
}

JointVector turned(int joint, double angle_deg) {
  JointVector joints_rad = test_start_rad();
  joints_rad[joint] += angle_deg * kRadPerDeg;
  return joints_rad;
}

TEST(CheckJointMotion, AllowsWhatStaysWithinTheLimits) {
  const CheckedMotion motion = check_joint_motion(test_arm(), test_start_rad(), turned(0, 60), 1.0);
  ASSERT_TRUE(motion.is_allowed()) << motion.text;
  EXPECT_GT(motion.speed, 0.0);
  EXPECT_LE(motion.speed, test_limits().joint_speed_rad_s);
  EXPECT_GT(motion.duration_s, 1.0);
}

// Joint 1 alone: the tip moves on a circle about the base's axis, so its speed is radius times
// speed.
TEST(CheckJointMotion, SlowsDownForTheTip) {
  const ArmWithTool arm = test_arm();
  const CheckedMotion motion = check_joint_motion(arm, test_start_rad(), turned(0, 60), 1.0);
  const Eigen::Vector3d tip_mm = arm.base_from_tcp(test_start_rad()).translation();
  const double tip_mm_s = tip_mm.head<2>().norm() * motion.speed;
  EXPECT_LE(tip_mm_s, arm.limits.tool_speed_mm_s);
  const CheckedMotion half = check_joint_motion(arm, test_start_rad(), turned(0, 60), 0.5);
  EXPECT_NEAR(half.speed, 0.5 * motion.speed, 1e-12);
}

TEST(CheckJointMotion, RefusesWhereALinkLeavesTheBoxOnTheWay) {
  MotionLimits limits = test_limits();
  // The tip's circle about the base's axis passes +y; start and goal lie within.
  const Eigen::Vector3d tip_mm = test_arm().base_from_tcp(test_start_rad()).translation();
  JointVector left = test_start_rad();
  JointVector right = test_start_rad();
  left[0] += kPi / 2.0 - std::atan2(tip_mm.y(), tip_mm.x()) + 50.0 * kRadPerDeg;
  right[0] += kPi / 2.0 - std::atan2(tip_mm.y(), tip_mm.x()) - 50.0 * kRadPerDeg;
  limits.box_max_mm[1] = 0.9 * tip_mm.head<2>().norm() + 40.0;
  const ArmWithTool arm = test_arm(limits);
  ASSERT_EQ(outside_box(arm, left, 0.0), "");
  ASSERT_EQ(outside_box(arm, right, 0.0), "");
  const CheckedMotion motion = check_joint_motion(arm, left, right, 1.0);
  EXPECT_EQ(motion.problem, Problem::kBox);
  EXPECT_THAT(motion.text, testing::HasSubstr("outside the box along y"));
}

TEST(CheckJointMotion, RefusesJointsBeyondTheirLimitAndNumbersThatAreNone) {
  const ArmWithTool arm = test_arm();
  EXPECT_EQ(check_joint_motion(arm, test_start_rad(), turned(5, 361), 1.0).problem,
            Problem::kJointLimit);
  JointVector none = test_start_rad();
  none[2] = std::nan("");
  EXPECT_EQ(check_joint_motion(arm, test_start_rad(), none, 1.0).problem, Problem::kJointLimit);
}

TEST(CheckLineMotion, KeepsTheTipOnTheLineAndItsSpeed) {
  const ArmWithTool arm = test_arm();
  Eigen::Isometry3d goal = arm.base_from_tcp(test_start_rad());
  goal.translation().z() += 60.0;
  const CheckedMotion motion = check_line_motion(arm, test_start_rad(), goal, 1.0);
  ASSERT_TRUE(motion.is_allowed()) << motion.text;
  EXPECT_LE(motion.speed, arm.limits.tool_speed_mm_s);
  EXPECT_LT(pose_difference(arm.base_from_tcp(motion.goal_rad), goal).norm(), 1e-6);
}

TEST(CheckLineMotion, RefusesWhatIsOutOfReachOrSingular) {
  const ArmWithTool arm = test_arm();
  Eigen::Isometry3d far = arm.base_from_tcp(test_start_rad());
  far.translation().x() *= 4.0;
  const CheckedMotion away = check_line_motion(arm, test_start_rad(), far, 1.0);
  EXPECT_TRUE(away.problem == Problem::kUnreachable || away.problem == Problem::kSingular);
  JointVector wrist = test_start_rad();
  wrist[4] = 1e-3;
  Eigen::Isometry3d goal = arm.base_from_tcp(wrist);
  goal.translation().z() += 10.0;
  EXPECT_EQ(check_line_motion(arm, wrist, goal, 1.0).problem, Problem::kSingular);
}

/// The fastest point of the arm along a checked motion, in steps of 1 ms.
double fastest_link_mm_s(const ArmWithTool& arm, const CheckedMotion& motion) {
  const JointVector way_rad = motion.goal_rad - motion.start_rad;
  const double length = way_rad.cwiseAbs().maxCoeff();
  const Trapezoid leading(length, motion.speed, motion.acceleration);
  const auto shape = [&](double t) {
    return arm_shape(arm.arm,
                     motion.start_rad + way_rad * (leading.at(t) / length),
                     arm.flange_from_tcp,
                     arm.tool_radius_mm);
  };
  double fastest = 0.0;
  for (double t = 0.0; t < leading.duration_s(); t += 0.01) {
    const ArmShape now = shape(t);
    const ArmShape next = shape(t + 0.001);
    for (std::size_t i = 0; i < now.size(); ++i) {
      fastest = std::max(fastest, (next[i].to_mm - now[i].to_mm).norm() / 0.001);
    }
  }
  return fastest;
}

TEST(CheckJointMotion, NoLinkIsEverFasterThanAllowed) {
  const ArmWithTool arm = test_arm();
  int allowed = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    Rng rng(11, Stream::kTest, i);
    JointVector goal_rad = test_start_rad();
    for (double& angle : goal_rad) {
      angle += rng.uniform(-0.6, 0.6);
    }
    const CheckedMotion motion = check_joint_motion(arm, test_start_rad(), goal_rad, 1.0);
    if (motion.is_allowed()) {
      ++allowed;
      EXPECT_LE(fastest_link_mm_s(arm, motion), arm.limits.tool_speed_mm_s);
    }
  }
  EXPECT_GT(allowed, 30);
}

}  // namespace
}  // namespace glint
