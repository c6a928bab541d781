// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one package of a controller does to a motion that goes on.
#include "hardware/robot/motion_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "tests/hardware/robot/cell_robot_settings.h"

namespace glint {
namespace {

using testing::HasSubstr;

/// A motion of joint 1 by half a radian that has been begun.
struct WatchedMotion {
  explicit WatchedMotion(const MotionLimits& limits = test_limits())
      : arm(arm_with_tool(settings, limits)) {}

  RobotState package(double stamp_s, double tool_speed_mm_s) const {
    RobotState state;
    state.timestamp_s = stamp_s;
    state.actual_q_rad = test_start_rad();
    state.actual_qd_rad_s[0] = 0.5;
    state.base_from_tcp = arm.base_from_tcp(test_start_rad());
    state.tcp_offset = arm.flange_from_tcp;
    state.tool_speed_mm_s = tool_speed_mm_s;
    state.robot_mode = RobotMode::kRunning;
    state.safety_mode = SafetyMode::kNormal;
    state.runtime_state = RuntimeState::kPlaying;
    state.ack = ack.begun;
    return state;
  }

  UrSettings settings = test_robot(ArmModel::kUr3e);
  ArmWithTool arm;
  ScriptAck ack = {.begun = 1, .ended = 2};
  JointVector goal_rad = test_start_rad() + JointVector{0.5, 0.0, 0.0, 0.0, 0.0, 0.0};
  MotionWatch watch{
      check_joint_motion(arm, test_start_rad(), goal_rad, 1.0), ack, arm, settings, 1.0, 0.0};
};

TEST(MotionWatch, StopsAToolThatIsFasterThanTheLimitItself) {
  const double limit_mm_s = test_limits().tool_speed_mm_s;
  WatchedMotion within;
  within.watch.on_package(within.package(0.1, 0.99 * limit_mm_s), 0.1);
  EXPECT_FALSE(within.watch.result().has_value());
  for (const double speed_mm_s : {1.001 * limit_mm_s, 1.05 * limit_mm_s, std::nan("")}) {
    WatchedMotion faster;
    faster.watch.on_package(faster.package(0.1, 0.5 * limit_mm_s), 0.1);
    faster.watch.on_package(faster.package(0.108, speed_mm_s), 0.108);
    ASSERT_TRUE(faster.watch.result().has_value()) << speed_mm_s;
    EXPECT_EQ(faster.watch.result()->outcome, MotionOutcome::kLimit);
    EXPECT_THAT(faster.watch.result()->text, HasSubstr("limits.tool_speed_mm_s is 250.0"));
    EXPECT_TRUE(faster.watch.must_stop());
  }
}

// The fastest that a motion is planned for leaves room below what stops it.
TEST(MotionWatch, LetsPlannedMotionsOvershootByATenth) {
  const WatchedMotion one;
  const CheckedMotion motion = check_joint_motion(one.arm, test_start_rad(), one.goal_rad, 1.0);
  const double tip_mm_s =
      motion.speed * one.arm.base_from_tcp(test_start_rad()).translation().head<2>().norm();
  EXPECT_LE(1.1 * tip_mm_s, 1.001 * one.arm.limits.tool_speed_mm_s);
}

TEST(MotionWatch, StopsAtOnePackageOutsideTheBox) {
  MotionLimits limits = test_limits();
  limits.box_min_mm[0] = -302.0;  // the arm just fits
  WatchedMotion motion(limits);
  motion.watch.on_package(motion.package(0.1, 100.0), 0.1);
  EXPECT_FALSE(motion.watch.result().has_value());
  RobotState outside = motion.package(0.108, 100.0);
  outside.actual_q_rad[1] += 10.0 * kRadPerDeg;  // lower and farther out
  motion.watch.on_package(outside, 0.108);
  ASSERT_TRUE(motion.watch.result().has_value());
  EXPECT_EQ(motion.watch.result()->outcome, MotionOutcome::kLimit);
  EXPECT_THAT(motion.watch.result()->text, HasSubstr("outside the box along x"));
  EXPECT_TRUE(motion.watch.must_stop());
  motion.watch.on_package(motion.package(0.116, 100.0), 0.116);
  EXPECT_EQ(motion.watch.result()->outcome, MotionOutcome::kLimit) << "back within, it stays so";
}

TEST(Stall, IsFivePeriodsAndAFifthOfASecondAtLeast) {
  EXPECT_DOUBLE_EQ(stall_s(125.0), 0.2);
  EXPECT_DOUBLE_EQ(stall_s(500.0), 0.2);
  EXPECT_DOUBLE_EQ(stall_s(10.0), 0.5);
}

}  // namespace
}  // namespace glint
