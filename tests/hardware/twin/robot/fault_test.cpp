// SPDX-License-Identifier: GPL-3.0-or-later
//
// Each fault of the twin becomes the right result of the product, and nothing moves after it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "tests/hardware/robot/cell_robot_settings.h"
#include "tests/hardware/twin/robot/twin_harness.h"

namespace glint {
namespace {

using testing::HasSubstr;
using enum MotionOutcome;

JointVector goal_rad() {
  return test_start_rad() + JointVector{0.9, 0.1, -0.2, 0.1, 0.2, 0.3};
}

struct FaultCase {
  FaultKind fault;
  MotionOutcome outcome;
  const char* says;
};

class FaultInMotion : public testing::TestWithParam<FaultCase> {};

TEST_P(FaultInMotion, IsTheRightResultWithinHalfASecondAndNothingMovesAfterIt) {
  for (const ArmModel model : {ArmModel::kUr3, ArmModel::kUr3e}) {
    if (GetParam().fault == FaultKind::kRemoteOff && is_cb3(model)) {
      continue;  // CB3 has no remote control
    }
    TwinHarness harness(model);
    harness.twin.add_fault(
        {.kind = GetParam().fault, .when = Fault::When::kMoving, .delay_s = 0.5});
    const auto result = harness.move(goal_rad());
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(name_of(result->outcome), name_of(GetParam().outcome)) << result->text;
    EXPECT_THAT(result->text, HasSubstr(GetParam().says));
    ASSERT_TRUE(harness.fault_at_s().has_value());
    EXPECT_LT(harness.now_s() - *harness.fault_at_s(), 0.5);
    harness.run(0.5);
    // A controller whose link is cut goes on with what it has: no byte reaches it.
    if (GetParam().fault != FaultKind::kCut) {
      EXPECT_EQ(harness.motion_rad(1.0), 0.0);
    }
    const std::size_t sent = harness.scripts().size();
    const bool may_go_on = GetParam().outcome == kUnreachable;
    if (!may_go_on) {
      harness.twin.add_fault({.kind = FaultKind::kRelease});
      const double moved_rad = harness.motion_rad(1.0);
      EXPECT_TRUE(moved_rad == 0.0 || GetParam().fault == FaultKind::kCut) << "it was reset";
      EXPECT_EQ(harness.move(goal_rad())->outcome, GetParam().outcome) << "the stop is named again";
      EXPECT_EQ(harness.scripts().size(), sent);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Each,
    FaultInMotion,
    testing::Values(FaultCase{FaultKind::kProtectiveStop, kProtectiveStop, "PROTECTIVE_STOP"},
                    FaultCase{FaultKind::kEmergencyStop, kEmergencyStop, "ROBOT_EMERGENCY_STOP"},
                    FaultCase{FaultKind::kSafeguardStop, kSafeguardStop, "SAFEGUARD_STOP"},
                    FaultCase{FaultKind::kJointLimit, kUnreachable, "joint limit"},
                    FaultCase{FaultKind::kSingular, kUnreachable, "singular"},
                    FaultCase{FaultKind::kUnreachable, kUnreachable, "inverse kin"},
                    FaultCase{FaultKind::kOverspeed, kLimit, "mm/s"},
                    FaultCase{FaultKind::kSilence, kLost, "no new package"},
                    FaultCase{FaultKind::kCut, kLost, "closed"},
                    FaultCase{FaultKind::kRestart, kLost, "closed"},
                    FaultCase{FaultKind::kOldStamps, kLost, "no new package"},
                    FaultCase{FaultKind::kWrongTcp, kLimit, "TCP"},
                    FaultCase{FaultKind::kRemoteOff, kProgramStopped, "before the arm"},
                    FaultCase{FaultKind::kOtherProgram, kProgramStopped, "another program"}),
    [](const testing::TestParamInfo<FaultCase>& one) {
      return std::string(kFaultNames.at(static_cast<std::size_t>(one.param.fault)));
    });

// What becomes of an arm whose controller keeps the program: it goes on by itself.
TEST(SafeguardStop, GoesOnWhenItIsResetUnlessTheProgramWasDropped) {
  for (const bool is_dropped : {true, false}) {
    TwinHarness harness;
    harness.twin.add_fault(
        {.kind = FaultKind::kSafeguardStop, .when = Fault::When::kMoving, .delay_s = 0.5});
    if (!is_dropped) {
      harness.leave_programs();
    }
    EXPECT_EQ(harness.move(goal_rad())->outcome, kSafeguardStop);
    EXPECT_EQ(harness.driver.may_hold_program(), !is_dropped);
    harness.run(0.5);
    harness.twin.add_fault({.kind = FaultKind::kRelease});
    const double moved_rad = harness.motion_rad(5.0);
    EXPECT_EQ(moved_rad == 0.0, is_dropped) << moved_rad;
    const double left_rad = (harness.twin.view().joints_rad - goal_rad()).norm();
    EXPECT_EQ(left_rad < 1e-9, !is_dropped) << left_rad;
  }
}

/// The controller is told to drop its program after this fault in motion.
bool is_program_dropped_after(FaultKind fault) {
  TwinHarness harness;
  harness.leave_programs();
  harness.twin.add_fault({.kind = fault, .when = Fault::When::kMoving, .delay_s = 0.5});
  EXPECT_TRUE(harness.move(goal_rad()).has_value());
  EXPECT_TRUE(harness.driver.halted().has_value());
  return harness.driver.may_hold_program();
}

// Of programs that have ended, and of others' that run in their place, there is nothing to drop.
TEST(Stops, DropTheProgramUnlessItIsKnownToBeGone) {
  for (const FaultKind fault : {FaultKind::kProtectiveStop,
                                FaultKind::kEmergencyStop,
                                FaultKind::kSafeguardStop,
                                FaultKind::kSilence,
                                FaultKind::kOldStamps,
                                FaultKind::kCut,
                                FaultKind::kRestart}) {
    EXPECT_TRUE(is_program_dropped_after(fault)) << static_cast<int>(fault);
  }
  for (const FaultKind fault :
       {FaultKind::kOtherProgram, FaultKind::kRemoteOff, FaultKind::kOverspeed}) {
    EXPECT_FALSE(is_program_dropped_after(fault)) << static_cast<int>(fault);
  }
}

TEST(Stops, SayWhenTheControllerMayKeepItsProgram) {
  TwinHarness harness;
  harness.leave_programs();
  harness.twin.add_fault(
      {.kind = FaultKind::kSafeguardStop, .when = Fault::When::kMoving, .delay_s = 0.5});
  harness.move(goal_rad());
  ASSERT_TRUE(harness.driver.may_hold_program());
  harness.driver.on_program_dropped("no answer");
  EXPECT_THAT(harness.driver.result()->text, HasSubstr("end it at the pendant (no answer)"));
  EXPECT_THAT(harness.move(goal_rad())->text, HasSubstr("end it at the pendant"));
}

struct RefusalCase {
  FaultKind fault;
  MotionOutcome outcome;
  const char* says;
};

TEST(FaultBeforeMotion, IsRefusedWithoutAByteOnTheScriptPorts) {
  const RefusalCase cases[] = {{FaultKind::kProtectiveStop, kProtectiveStop, "PROTECTIVE_STOP"},
                               {FaultKind::kEmergencyStop, kEmergencyStop, "EMERGENCY"},
                               {FaultKind::kSafeguardStop, kSafeguardStop, "SAFEGUARD"},
                               {FaultKind::kSilence, kLost, "no new package"},
                               {FaultKind::kOldStamps, kLost, "no new package"},
                               {FaultKind::kCut, kLost, "closed"},
                               {FaultKind::kRestart, kLost, "closed"},
                               {FaultKind::kWrongTcp, kRefused, "TCP"},
                               {FaultKind::kWrongPayload, kRefused, "payload"},
                               {FaultKind::kOtherProgram, kRefused, "another program"}};
  for (const RefusalCase& one : cases) {
    TwinHarness harness;
    harness.twin.add_fault({.kind = one.fault});
    harness.run(0.5);
    const auto result = harness.move(goal_rad());
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(name_of(result->outcome), name_of(one.outcome)) << result->text;
    EXPECT_THAT(result->text, HasSubstr(one.says));
    EXPECT_EQ(harness.scripts(), "");
  }
}

TEST(FaultInExposure, ProtectiveStopAtStandstillEndsItAndIsNamed) {
  TwinHarness harness;
  harness.twin.add_fault(
      {.kind = FaultKind::kProtectiveStop, .when = Fault::When::kStill, .delay_s = 0.05});
  ASSERT_TRUE(harness.move(goal_rad())->is_done());
  harness.driver.restart_still_pose();
  harness.run(0.4);
  EXPECT_FALSE(harness.driver.still_pose().has_value());
  ASSERT_TRUE(harness.driver.halted().has_value());
  EXPECT_EQ(harness.driver.halted()->outcome, kProtectiveStop);
}

TEST(RemoteControlOff, MotionThatTheControllerIgnoresTimesOut) {
  TwinHarness harness;
  harness.twin.add_fault({.kind = FaultKind::kRemoteOff});
  harness.run(0.1);
  const auto result = harness.move(goal_rad());
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->outcome, kTimeout);
  harness.run(0.1);
  EXPECT_THAT(harness.scripts(), HasSubstr("stopj")) << "what may begin later is stopped";
}

TEST(Motion, ArrivesAndStandsStill) {
  for (const ArmModel model : {ArmModel::kUr3, ArmModel::kUr3e, ArmModel::kUr5e}) {
    TwinHarness harness(model);
    const auto result = harness.move(goal_rad());
    ASSERT_TRUE(result.has_value());
    ASSERT_TRUE(result->is_done()) << result->text;
    harness.run(0.4);
    ASSERT_TRUE(harness.driver.still_pose().has_value());
    EXPECT_LT((harness.driver.still_pose()->joints_rad - goal_rad()).norm(), 1e-6);
    EXPECT_THAT(harness.scripts(), testing::Not(HasSubstr("speed"))) << "the slider is left alone";
  }
}

// Packages come every 8 ms; the link is lost after 0.2 s without a new one, by the product's clock.
TEST(Silence, OfAFifthOfASecondIsALostLink) {
  for (const double silence_s : {0.19, 0.21}) {
    TwinHarness harness(ArmModel::kUr3);
    harness.driver.on_time(harness.now_s() + silence_s);
    EXPECT_EQ(harness.driver.halted().has_value(), silence_s > 0.2) << silence_s;
  }
}

// The reason is told once.
TEST(Silence, InMotionLeavesUnknownWhetherTheArmStands) {
  TwinHarness harness(ArmModel::kUr3);
  harness.twin.add_fault({.kind = FaultKind::kSilence, .when = Fault::When::kMoving});
  const auto result = harness.move(goal_rad());
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->outcome, MotionOutcome::kLost);
  EXPECT_EQ(result->text, "no new package for 0.20 s; whether the arm stands is not known");
}

TEST(Motion, FollowsALine) {
  TwinHarness harness;
  Eigen::Isometry3d goal = harness.driver.arm().base_from_tcp(test_start_rad());
  goal.translation() += Eigen::Vector3d(30.0, 40.0, 50.0);
  const auto result = harness.move_line(goal);
  ASSERT_TRUE(result.has_value());
  ASSERT_TRUE(result->is_done()) << result->text;
  const JointVector left =
      pose_difference(harness.driver.state(harness.now_s())->base_from_tcp, goal);
  EXPECT_LT(left.head<3>().norm(), 1e-3);
}

TEST(Motion, WorksWhenEveryReplyComesByteByByte) {
  TwinHarness harness;
  harness.twin.add_fault({.kind = FaultKind::kSplit});
  harness.run(0.1);
  EXPECT_TRUE(harness.move(goal_rad())->is_done());
}

TEST(Motion, OutOfTheBoxIsUnreachableAndNothingIsSent) {
  TwinHarness harness;
  JointVector low = test_start_rad();
  low[1] = 20.0 * kRadPerDeg;
  const auto result = harness.move(low);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->outcome, kUnreachable);
  EXPECT_THAT(result->text, HasSubstr("outside the box"));
  EXPECT_EQ(harness.scripts(), "");
  EXPECT_TRUE(harness.move(goal_rad())->is_done()) << "another goal may follow";
}

TEST(Motion, CanBeStopped) {
  TwinHarness harness;
  const CheckedMotion motion =
      check_joint_motion(harness.driver.arm(), test_start_rad(), goal_rad(), 1.0);
  ASSERT_FALSE(harness.driver.begin(motion, harness.now_s()).has_value());
  harness.run(0.7);
  ASSERT_FALSE(harness.driver.begin_stop(harness.now_s()).has_value());
  harness.run(1.5);
  ASSERT_TRUE(harness.driver.result().has_value());
  EXPECT_TRUE(harness.driver.result()->is_done());
  EXPECT_EQ(harness.motion_rad(1.0), 0.0);
  EXPECT_GT((harness.twin.view().joints_rad - goal_rad()).norm(), 0.05);
}

// Versions, outputs, start: no inputs, by which a client could move the slider or switch lights.
TEST(Driver, AsksForNoInputs) {
  TwinHarness harness;
  EXPECT_TRUE(harness.move(goal_rad())->is_done());
  FrameSplitter frames = FrameSplitter::of_rtde();
  frames.append(harness.requests());
  std::string kinds;
  while (const auto frame = frames.next()) {
    kinds += static_cast<char>(frame->kind);
  }
  EXPECT_EQ(kinds, "VvOS");
}

TEST(Driver, NeverMakesAScriptWithoutAPermit) {
  UrDriver driver(test_robot(ArmModel::kUr3e),
                  arm_with_tool(test_robot(ArmModel::kUr3e), test_limits()));
  EXPECT_EQ(driver.begin(CheckedMotion{}, 0.0)->outcome, kRefused);
  EXPECT_EQ(driver.begin_stop(0.0)->outcome, kRefused);
  EXPECT_EQ(driver.take_script_output(), "");
}

}  // namespace
}  // namespace glint
