// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one package of a controller does to a motion that goes on.
#include "hardware/robot/motion_watch.h"

#include <cmath>

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

  /// Before the motion begins.
  RobotState idle_package(double stamp_s) const {
    RobotState state = package(stamp_s, 0.0);
    state.actual_qd_rad_s.setZero();
    state.runtime_state = RuntimeState::kStopped;
    state.ack = 0;
    return state;
  }

  UrSettings settings = test_robot(ArmModel::kUr3e);
  ArmWithTool arm;
  ScriptAck ack = {.begun = 1, .beat = 2, .ended = 3};
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

// The tool's own joint moves no link that the box is asked for, and a joint's motion needs no pose
// of the TCP.
TEST(MotionWatch, StopsAnArmWhosePoseIsNotTold) {
  void (*const losses[])(RobotState&) = {
      [](RobotState& state) { state.actual_q_rad[5] = std::nan(""); },
      [](RobotState& state) { state.actual_qd_rad_s[2] = std::nan(""); },
      [](RobotState& state) { state.base_from_tcp.translation().x() = std::nan(""); },
      [](RobotState& state) {
        state.base_from_tcp = pose_of_six({0, 0, 0, std::nan(""), 0, 0});
      }};
  for (const auto& lose : losses) {
    WatchedMotion motion;
    motion.watch.on_package(motion.package(0.1, 100.0), 0.1);
    RobotState state = motion.package(0.108, 100.0);
    lose(state);
    motion.watch.on_package(state, 0.108);
    ASSERT_TRUE(motion.watch.result().has_value());
    EXPECT_EQ(motion.watch.result()->outcome, MotionOutcome::kLost);
    EXPECT_EQ(motion.watch.result()->text, "the robot's pose is unknown");
    EXPECT_TRUE(motion.watch.must_stop());
  }
}

// A hand is at the arm.
TEST(MotionWatch, StopsAnArmWhoseTeachButtonIsPressed) {
  WatchedMotion motion;
  RobotState state = motion.package(0.1, 100.0);
  state.robot_status_bits = kStatusPowerOn | kStatusProgramRunning;
  motion.watch.on_package(state, 0.1);
  EXPECT_FALSE(motion.watch.result().has_value());
  state.timestamp_s = 0.108;
  state.robot_status_bits |= kStatusTeachButton;
  motion.watch.on_package(state, 0.108);
  ASSERT_TRUE(motion.watch.result().has_value());
  EXPECT_EQ(motion.watch.result()->outcome, MotionOutcome::kProgramStopped);
  EXPECT_EQ(motion.watch.result()->text, "the teach button was pressed");
  EXPECT_TRUE(motion.watch.must_stop());
}

// Whose exception it is, is not known: what may begin yet is stopped.
TEST(MotionWatch, AnExceptionBeforeTheMotionBeginsEndsItInAStop) {
  WatchedMotion motion;
  motion.watch.on_message({.kind = PrimaryMessage::Kind::kRuntimeException, .text = "no reason"});
  EXPECT_FALSE(motion.watch.result().has_value());
  motion.watch.on_package(motion.idle_package(0.1), 0.1);
  EXPECT_FALSE(motion.watch.result().has_value());
  motion.watch.on_package(motion.idle_package(0.25), 0.25);
  ASSERT_TRUE(motion.watch.result().has_value());
  EXPECT_EQ(motion.watch.result()->outcome, MotionOutcome::kProgramStopped);
  EXPECT_EQ(motion.watch.result()->text, "no reason");
  EXPECT_TRUE(motion.watch.must_stop());
}

TEST(MotionWatch, GoesOnAfterAnExceptionWhenTheMotionBegins) {
  WatchedMotion motion;
  motion.watch.on_message({.kind = PrimaryMessage::Kind::kRuntimeException, .text = "another's"});
  for (const double stamp_s : {0.1, 0.2, 0.3, 0.4}) {
    motion.watch.on_package(motion.package(stamp_s, 100.0), stamp_s);
    EXPECT_FALSE(motion.watch.result().has_value());
  }
}

/// How a motion ends of which no end comes, begun at this speed scaling; what the package tells
/// that is the last.
MotionResult end_of_endless(double speed_scaling, RuntimeState runtime, double last_scaling) {
  WatchedMotion motion;
  MotionWatch watch(check_joint_motion(motion.arm, test_start_rad(), motion.goal_rad, 1.0),
                    motion.ack,
                    motion.arm,
                    motion.settings,
                    speed_scaling,
                    0.0);
  watch.on_package(motion.package(0.1, 0.0), 0.1);
  RobotState late = motion.package(1000.0, 0.0);
  late.runtime_state = runtime;
  late.speed_scaling = last_scaling;
  watch.on_package(late, 0.2);
  EXPECT_TRUE(watch.must_stop());
  return watch.result().value_or(MotionResult{});
}

// Half a radian takes some 2 s, 20 times as long at the slowest.
TEST(MotionWatch, WaitsForNoMotionWithoutEndAndTellsWhatHoldsItUp) {
  for (const double scaling : {1.0, 0.0, -1.0, std::nan("")}) {
    const MotionResult result = end_of_endless(scaling, RuntimeState::kPlaying, 1.0);
    EXPECT_EQ(result.outcome, MotionOutcome::kTimeout) << scaling;
    EXPECT_EQ(result.text, "the arm did not arrive in time");
  }
  EXPECT_THAT(end_of_endless(1.0, RuntimeState::kPaused, 1.0).text,
              HasSubstr("in time; program PAUSED"));
  EXPECT_THAT(end_of_endless(1.0, RuntimeState::kPlaying, 0.0).text,
              HasSubstr("it goes at 0 % of its speed"));
}

TEST(MotionWatch, StopsAnArmThatLeavesItsWay) {
  WatchedMotion motion;
  RobotState state = motion.package(0.1, 100.0);
  state.actual_q_rad[0] += 0.2;
  state.actual_q_rad[5] += 0.02;
  motion.watch.on_package(state, 0.1);
  EXPECT_FALSE(motion.watch.result().has_value()) << "on its way";
  state.timestamp_s = 0.108;
  state.actual_q_rad[5] += 0.02;
  motion.watch.on_package(state, 0.108);
  ASSERT_TRUE(motion.watch.result().has_value());
  EXPECT_EQ(motion.watch.result()->outcome, MotionOutcome::kProgramStopped);
  EXPECT_THAT(motion.watch.result()->text, HasSubstr("has left its way"));
  EXPECT_TRUE(motion.watch.must_stop());
}

/// When another program is named, if packages of 8 ms hold these values of the register in turns.
std::optional<double> other_program_s(const std::vector<std::int32_t>& acks,
                                      RuntimeState runtime = RuntimeState::kPlaying,
                                      double period_s = 0.008) {
  WatchedMotion motion;
  for (std::size_t i = 0; period_s * static_cast<double>(i) < 3.0; ++i) {
    RobotState state = motion.package(period_s * static_cast<double>(i), 0.0);
    state.actual_qd_rad_s.setZero();
    state.speed_scaling = 0.0;  // a slider at nought tells nothing
    state.runtime_state = runtime;
    state.ack = i == 0 ? motion.ack.begun : acks[i / 3 % acks.size()];
    motion.watch.on_package(state, state.timestamp_s);
    if (motion.watch.result()) {
      EXPECT_EQ(motion.watch.result()->outcome, MotionOutcome::kProgramStopped);
      EXPECT_THAT(motion.watch.result()->text, HasSubstr("another program"));
      EXPECT_TRUE(motion.watch.is_other_program());
      EXPECT_FALSE(motion.watch.must_stop()) << "it is left alone";
      return state.timestamp_s;
    }
  }
  return std::nullopt;
}

// Wherever the arm stands: at its start, on its way, or at its goal after the program's last line.
TEST(MotionWatch, NamesAnotherProgramWhenItsOwnNoLongerWritesTheRegister) {
  EXPECT_LT(other_program_s({1}).value_or(9.0), 0.3);
  EXPECT_LT(other_program_s({2}).value_or(9.0), 0.3);
  EXPECT_LT(other_program_s({3}).value_or(9.0), 0.3);
  EXPECT_LT(other_program_s({2, 17}).value_or(9.0), 0.03) << "what it does not write itself";
  EXPECT_FALSE(other_program_s({1, 2}).has_value());
  EXPECT_FALSE(other_program_s({1}, RuntimeState::kPaused).has_value());
}

// A twin's clock may be faster than its packages: a register that changes every 20 ms is the same
// in all of them where they lie 80 ms apart.
TEST(MotionWatch, PackagesFurtherApartThanTheRegisterChangesTellNothing) {
  for (const double period_s : {0.02, 0.08, 0.32}) {
    EXPECT_FALSE(other_program_s({1}, RuntimeState::kPlaying, period_s).has_value()) << period_s;
  }
  EXPECT_LT(other_program_s({1}, RuntimeState::kPlaying, 0.016).value_or(9.0), 0.3);
}

TEST(MotionWatch, AProgramThatRunsInsteadOfTheMotionIsLeftAlone) {
  WatchedMotion motion;
  for (double stamp_s = 0.1; stamp_s < 0.6 && !motion.watch.result(); stamp_s += 0.008) {
    RobotState state = motion.package(stamp_s, 0.0);
    state.ack = 0;
    motion.watch.on_package(state, stamp_s);
  }
  ASSERT_TRUE(motion.watch.result().has_value());
  EXPECT_EQ(motion.watch.result()->outcome, MotionOutcome::kProgramStopped);
  EXPECT_THAT(motion.watch.result()->text, HasSubstr("another program"));
  EXPECT_FALSE(motion.watch.must_stop());
}

TEST(Stall, IsFivePeriodsAndAFifthOfASecondAtLeast) {
  EXPECT_DOUBLE_EQ(stall_s(125.0), 0.2);
  EXPECT_DOUBLE_EQ(stall_s(500.0), 0.2);
  EXPECT_DOUBLE_EQ(stall_s(10.0), 0.5);
}

}  // namespace
}  // namespace glint
