// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stops go out, are waited for, and no motion goes out after one.
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hardware/robot/cell_robot_settings.h"
#include "tests/hardware/twin/robot/twin_harness.h"

namespace glint {
namespace {

using testing::HasSubstr;
using testing::Not;
using enum MotionOutcome;

JointVector far_rad() {
  return test_start_rad() + JointVector{1.5, 0.05, -0.1, 0.0, 0.1, 0.2};
}

void begin_motion(TwinHarness& harness) {
  const CheckedMotion motion =
      check_joint_motion(harness.driver.arm(), test_start_rad(), far_rad(), 1.0);
  ASSERT_FALSE(harness.driver.begin(motion, harness.now_s()).has_value());
}

TEST(Stop, OfAMotionHasItsResultWhenTheArmStandsStill) {
  TwinHarness harness;
  harness.twin.add_fault(
      {.kind = FaultKind::kOverspeed, .when = Fault::When::kMoving, .delay_s = 0.5});
  const auto result = harness.move(far_rad());
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->outcome, kLimit) << result->text;
  EXPECT_TRUE(harness.twin.view().is_still);
  EXPECT_EQ(harness.motion_rad(1.0), 0.0);
  EXPECT_GT((harness.twin.view().joints_rad - far_rad()).norm(), 0.05);
}

TEST(Stop, ThatDoesNotWorkIsSaidSo) {
  TwinHarness harness;
  begin_motion(harness);
  harness.run(0.5);
  harness.twin.add_fault({.kind = FaultKind::kOverspeed});
  harness.run_without_scripts(0.1);
  ASSERT_FALSE(harness.driver.result().has_value()) << "the stop has not gone out";
  harness.run_without_scripts(3.1);
  ASSERT_TRUE(harness.driver.result().has_value());
  EXPECT_EQ(harness.driver.result()->outcome, kLimit);
  EXPECT_THAT(harness.driver.result()->text, HasSubstr("the arm did not stop"));
}

TEST(Stop, BySafetyDropsAMotionThatHasNotGoneOut) {
  TwinHarness harness;
  begin_motion(harness);
  harness.twin.add_fault({.kind = FaultKind::kProtectiveStop});
  harness.run_without_scripts(0.05);
  EXPECT_EQ(harness.driver.take_script_output(), "");
  ASSERT_TRUE(harness.driver.result().has_value());
  EXPECT_EQ(harness.driver.result()->outcome, kProtectiveStop);
}

TEST(Stop, OfALostLinkGoesOutAlone) {
  for (const bool is_rtde : {true, false}) {
    TwinHarness harness;
    begin_motion(harness);
    if (is_rtde) {
      harness.driver.on_rtde_closed("the connection was closed");
    } else {
      harness.driver.on_primary_closed("the connection was closed");
    }
    const std::string script = harness.driver.take_script_output();
    EXPECT_THAT(script, HasSubstr("stopj"));
    EXPECT_THAT(script, Not(HasSubstr("movej")));
  }
}

TEST(Stop, ThatIsAskedForDropsAMotionThatHasNotGoneOut) {
  TwinHarness harness;
  begin_motion(harness);
  ASSERT_FALSE(harness.driver.begin_stop(harness.now_s()).has_value());
  EXPECT_THAT(harness.driver.take_script_output(), Not(HasSubstr("movej")));
}

TEST(Stop, ThatMayNotHaveArrivedGoesOutAgain) {
  TwinHarness harness;
  begin_motion(harness);
  harness.run(0.5);
  ASSERT_FALSE(harness.driver.begin_stop(harness.now_s()).has_value());
  EXPECT_THAT(harness.driver.take_script_output(), HasSubstr("stopj"));
  harness.driver.on_primary_closed("the connection was closed");
  EXPECT_THAT(harness.driver.take_script_output(), HasSubstr("stopj"));
}

// Nobody would tell that the arm has stopped: after a stop of another kind, too.
TEST(Stop, IsRefusedWhenTheLinkIsLost) {
  TwinHarness harness;
  harness.twin.add_fault({.kind = FaultKind::kProtectiveStop});
  harness.run(0.1);
  harness.twin.add_fault({.kind = FaultKind::kCut});
  harness.run(0.1);
  EXPECT_EQ(harness.driver.halted()->outcome, kProtectiveStop);
  const auto result = harness.driver.begin_stop(harness.now_s());
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->outcome, kLost);
}

TEST(Stop, WhoseEndNobodyTellsIsNotDone) {
  TwinHarness harness;
  begin_motion(harness);
  harness.run(0.5);
  ASSERT_FALSE(harness.driver.begin_stop(harness.now_s()).has_value());
  EXPECT_THAT(harness.driver.take_script_output(), HasSubstr("stopj"));
  harness.driver.on_rtde_closed("the connection was closed");
  harness.driver.on_time(harness.now_s());
  harness.driver.on_time(harness.now_s() + 5.0);
  ASSERT_TRUE(harness.driver.result().has_value());
  EXPECT_EQ(harness.driver.result()->outcome, kLost);
}

TEST(Stop, OfAnInterruptEndsTheMotionWhereItIs) {
  TwinHarness harness;
  begin_motion(harness);
  harness.run(0.5);
  harness.driver.interrupt(harness.now_s());
  harness.run(1.0);
  ASSERT_TRUE(harness.driver.result().has_value());
  EXPECT_EQ(harness.driver.result()->outcome, kProgramStopped);
  EXPECT_EQ(harness.driver.result()->text, "interrupted");
  EXPECT_EQ(harness.motion_rad(1.0), 0.0);
  EXPECT_GT((harness.twin.view().joints_rad - far_rad()).norm(), 0.05);
}

TEST(OtherProgram, ThatLetsTheArmStandIsLeftAlone) {
  TwinHarness harness;
  harness.twin.add_fault(
      {.kind = FaultKind::kOtherProgram, .when = Fault::When::kMoving, .delay_s = 0.5});
  EXPECT_EQ(harness.move(far_rad())->outcome, kProgramStopped);
  EXPECT_LT(harness.now_s() - harness.fault_at_s().value(), 0.5);
  harness.run(1.0);
  EXPECT_THAT(harness.scripts(), Not(HasSubstr("stopj")));
}

TEST(RemoteControlOff, TheReasonOfATimeoutIsNamedAgainAtTheNextMotion) {
  TwinHarness harness;
  harness.twin.add_fault({.kind = FaultKind::kRemoteOff});
  harness.run(0.1);
  EXPECT_EQ(harness.move(far_rad())->outcome, kTimeout);
  harness.driver.explain_timeout("remote control is off");
  EXPECT_EQ(harness.driver.result()->outcome, kProgramStopped);
  const auto again = harness.move(far_rad());
  EXPECT_EQ(again->outcome, kProgramStopped);
  EXPECT_EQ(again->text, "remote control is off (the controller did not begin the motion)");
}

// Somebody has changed it at the pendant since the arm arrived: its pose is of another point.
TEST(Standstill, WithAnotherTcpThanTheCellsIsNone) {
  TwinHarness harness;
  harness.run(0.5);
  EXPECT_TRUE(harness.driver.still_pose().has_value());
  harness.twin.add_fault({.kind = FaultKind::kWrongTcp});
  harness.run(0.5);
  EXPECT_FALSE(harness.driver.still_pose().has_value());
  harness.twin.add_fault({.kind = FaultKind::kRelease});
  harness.run(0.5);
  EXPECT_TRUE(harness.driver.still_pose().has_value());
}

// The controller finds other joints for the end of a line than the nominal arm has there.
TEST(Line, OfACalibratedArmArrivesByItsPose) {
  TwinSettings settings = test_twin(ArmModel::kUr3e);
  ArmDeltas deltas = {.model = ArmModel::kUr3e};
  deltas.a_mm[1] = 3.0;
  deltas.d_mm[4] = 3.0;
  settings.arm = Arm(ArmModel::kUr3e, deltas);
  TwinHarness harness(settings);
  Eigen::Isometry3d goal = harness.driver.arm().base_from_tcp(test_start_rad());
  goal.translation() += Eigen::Vector3d(30.0, 40.0, 50.0);
  const auto result = harness.move_line(goal);
  ASSERT_TRUE(result.has_value());
  EXPECT_TRUE(result->is_done()) << name_of(result->outcome) << result->text;
}

}  // namespace
}  // namespace glint
