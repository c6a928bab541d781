// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/acquisition/acquisition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include <fmt/format.h>

#include "tests/hardware/acquisition/bench.h"
#include "tests/hardware/acquisition/fake_cell.h"

namespace glint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Acquire, TakesEachPositionAtItsViewUnderItsLights) {
  Bench bench(2);
  const AcquisitionResult result = bench.run();
  EXPECT_TRUE(result.is_complete()) << result.text;
  EXPECT_EQ(result.end, AcquisitionEnd::kTour);
  EXPECT_EQ(result.where, "home");
  EXPECT_EQ(result.accepted, 4);
  EXPECT_THAT(bench.cell.events,
              ElementsAre("move",  // the point on the way, in the dark
                          "camera starts",
                          "light ring on",
                          "light bar off",
                          "move",
                          "stage 0",
                          "picture",
                          "stage 1",
                          "picture",
                          "light ring off",
                          "camera starts",
                          "light bar on",
                          "move",
                          "stage 0",
                          "picture",
                          "stage 1",
                          "picture",
                          "light bar off",
                          "move"));
  ASSERT_EQ(bench.taken.size(), 4U);
  EXPECT_EQ(bench.taken[1].pose.joints_rad, joints(0.5, 0.5));
  EXPECT_EQ(bench.taken[2].pose.joints_rad, joints(1.0, 0.5));
  EXPECT_EQ(bench.taken[3].frame.exposure_us, 200);
}

TEST(Acquire, KeepsRejectedPicturesApartAndGoesOn) {
  Bench bench(1);
  bench.camera.dim_ = true;
  const AcquisitionResult result = bench.run();
  EXPECT_EQ(result.cause, AcquisitionCause::kNone);
  EXPECT_FALSE(result.is_complete());
  EXPECT_EQ(result.missing, 2);
  EXPECT_EQ(result.rejected, 6);  // three tries each
  EXPECT_EQ(result.end, AcquisitionEnd::kTour);
  EXPECT_THAT(bench.taken[0].reason, HasSubstr("too dark"));
  EXPECT_EQ(bench.taken[2].attempt, 2);
}

// Twice the 0.8 px of the scene's camera and half a pixel more are allowed: 2.1 px.
TEST(Acquire, RejectsSinglePicturesThatAreBlurred) {
  for (const auto& [edge_px, is_sharp] : {std::pair(0.9, true), std::pair(4.0, false)}) {
    Bench bench(1);
    for (ViewTask& task : bench.plan.tasks) {
      task.expected.blur_px = 0.8;
    }
    bench.camera.edge_px_ = edge_px;
    EXPECT_EQ(bench.run().is_complete(), is_sharp) << edge_px;
    EXPECT_EQ(bench.taken[0].reason.starts_with("blurred: its edges"), !is_sharp);
  }
}

// Of a scan nobody knows how sharp it should be: the second picture tells it of the first.
TEST(Acquire, TakesTheFirstPictureOfAScanAgainThatIsBlurred) {
  Bench bench(3);
  bench.plan.tasks.resize(1);
  bench.camera.edge_px_ = 0.9;
  bench.camera.first_edge_px_ = 4.0;
  const AcquisitionResult result = bench.run();
  EXPECT_TRUE(result.is_complete()) << result.text;
  EXPECT_EQ(result.rejected, 1);
  ASSERT_EQ(bench.taken.size(), 4U);
  EXPECT_EQ(bench.taken[0].position, 0);
  EXPECT_FALSE(bench.taken[0].is_accepted);
  EXPECT_THAT(bench.taken[0].reason, HasSubstr("blurred"));
  EXPECT_EQ(bench.taken[1].position, 0);
  EXPECT_EQ(bench.taken[1].attempt, 1);
  EXPECT_EQ(bench.taken[3].position, 2);
}

TEST(Acquire, RefusesAnArmThatStandsOnNoPlannedWay) {
  Bench bench(1);
  bench.cell.joints_[4] = 0.1;
  const AcquisitionResult result = bench.run();
  EXPECT_EQ(result.cause, AcquisitionCause::kOffTour);
  EXPECT_EQ(result.end, AcquisitionEnd::kStopped);
  EXPECT_EQ(bench.cell.motions, 0);
  EXPECT_THAT(result.text, HasSubstr("5.7 degrees"));  // 0.1 rad
}

TEST(Acquire, BeginsWhereAKilledRunLeftTheArm) {
  for (const JointVector& start : {joints(0.25, 0), joints(0.5, 0.5), joints(0.8, 0.5)}) {
    Bench bench(1);
    bench.cell.joints_ = start;
    const AcquisitionResult result = bench.run();
    EXPECT_TRUE(result.is_complete()) << result.text;
    EXPECT_EQ(bench.taken.size(), 2U);
    EXPECT_EQ(result.where, "home");
  }
}

struct Row {
  FakeFault fault;
  AcquisitionCause cause;
};

const std::vector<Row> kFaults = {{FakeFault::kCameraTimeout, AcquisitionCause::kCamera},
                                  {FakeFault::kCameraLost, AcquisitionCause::kCamera},
                                  {FakeFault::kLight, AcquisitionCause::kLight},
                                  {FakeFault::kStage, AcquisitionCause::kStage},
                                  {FakeFault::kSink, AcquisitionCause::kSink},
                                  {FakeFault::kProgram, AcquisitionCause::kSink},
                                  {FakeFault::kInterrupt, AcquisitionCause::kInterrupted},
                                  {FakeFault::kProtectiveStop, AcquisitionCause::kRobot},
                                  {FakeFault::kEmergencyStop, AcquisitionCause::kRobot},
                                  {FakeFault::kSilence, AcquisitionCause::kRobot},
                                  {FakeFault::kPushed, AcquisitionCause::kRobot},
                                  {FakeFault::kUnreachable, AcquisitionCause::kRobot}};

int calls_of_a_whole_run() {
  Bench bench(2);
  bench.run();
  return bench.cell.calls;
}

/// What must hold after any fault at any step; then the run is taken up again.
void check_fault(const Row& row, int step) {
  SCOPED_TRACE(fmt::format("fault {} at call {}", static_cast<int>(row.fault), step));
  Bench bench(2);
  bench.cell.fault = row.fault;
  bench.cell.fault_at = step;
  const AcquisitionResult result = bench.run();
  if (result.is_complete()) {
    // It came too late to matter, or acts in a call that came no more.
    EXPECT_EQ(result.end, AcquisitionEnd::kTour);
  } else if (is_of_arm(row.fault)) {
    EXPECT_EQ(result.end, AcquisitionEnd::kStopped) << result.text;
    EXPECT_LE(bench.cell.motions_after_fault, 1) << "only the motion in which it acted";
  } else {
    EXPECT_EQ(result.cause, row.cause) << result.text;
    EXPECT_EQ(result.end, AcquisitionEnd::kBackedOut) << result.text;
    EXPECT_EQ(bench.cell.joints_, joints(0, 0));
    EXPECT_EQ(result.where, "home");
  }
  bench.cell.fault = FakeFault::kNone;
  bench.cell.safety = SafetyMode::kNormal;
  bench.cell.is_silent = false;
  bench.cell.interrupt = 0;
  if (row.fault == FakeFault::kPushed) {
    bench.cell.joints_[2] = 0.0;
  }
  bench.forget_taken();
  EXPECT_TRUE(bench.run().is_complete());
  std::map<std::pair<std::size_t, int>, int> times;
  for (const TakenPicture& picture : bench.taken) {
    ++times[{picture.task, picture.position}];
    const TourPoint& point = bench.plan.tour[bench.plan.tasks[picture.task].point];
    EXPECT_EQ(picture.pose.joints_rad, point.joints_rad);
  }
  EXPECT_EQ(times.size(), 4U);
  EXPECT_EQ(bench.taken.size(), 4U) << "none missing, none doubled";
}

TEST(Acquire, BacksOutOrStandsStillAfterEveryFaultAtEveryStep) {
  const int steps = calls_of_a_whole_run();
  EXPECT_GT(steps, 30);
  for (const Row& row : kFaults) {
    for (int step = 1; step <= steps + 1; ++step) {
      check_fault(row, step);
    }
  }
}

// The control: the fake does count motions that come after a stop.
TEST(FakeRobot, CountsMotionsAfterAStop) {
  Bench bench(1);
  bench.cell.fault = FakeFault::kProtectiveStop;
  bench.cell.call(FakeFault::kNone);
  bench.robot.move_joints(joints(0.5, 0), 1.0);
  bench.robot.move_joints(joints(0.5, 0), 1.0);
  EXPECT_EQ(bench.cell.motions_after_fault, 2);
}

TEST(Acquire, TakesAPictureAgainThatWasRefusedOrLostOnce) {
  for (const FakeFault fault : {FakeFault::kCameraRefusesOnce, FakeFault::kCameraComesBack}) {
    Bench bench(2);
    bench.cell.fault = fault;
    bench.cell.fault_at = 5;
    EXPECT_TRUE(bench.run().is_complete());
    EXPECT_TRUE(bench.cell.has_acted);
  }
}

// Whenever it is lost: also while it is stopped, configured and started for another exposure.
TEST(Acquire, OpensACameraAgainThatIsLostWhileItIsConfigured) {
  const int steps = calls_of_a_whole_run();
  int while_configured = 0;
  for (int step = 1; step <= steps; ++step) {
    Bench bench(2);
    bench.cell.fault = FakeFault::kCameraComesBack;
    bench.cell.fault_at = step;
    const AcquisitionResult result = bench.run();
    EXPECT_TRUE(result.is_complete()) << step << ": " << result.text;
    EXPECT_EQ(bench.taken.size(), 4U);
    EXPECT_EQ(bench.taken.back().frame.exposure_us, 200);
    while_configured += bench.camera.lost_while_configured_;
  }
  EXPECT_GT(while_configured, 1);
}

// Somebody has reset it before anybody looked: the arm stands where it stood, in a normal mode.
TEST(Acquire, APictureDuringAStopDoesNotCountThoughItWasReset) {
  Bench bench(1);
  bench.cell.during_exposure = [&bench] {
    bench.cell.halted =
        MotionResult{.outcome = MotionOutcome::kProtectiveStop, .text = "safety mode"};
  };
  const AcquisitionResult result = bench.run();
  EXPECT_EQ(result.accepted, 0);
  EXPECT_EQ(result.cause, AcquisitionCause::kRobot);
  EXPECT_EQ(result.text, "protective_stop: safety mode");
  EXPECT_EQ(result.end, AcquisitionEnd::kStopped);
  EXPECT_EQ(bench.cell.motions, 2) << "the way to the first view alone";
}

// The arm stands where it stood, and nothing has stopped it.
TEST(Acquire, APictureDuringWhichTheControllerIsNotReadyDoesNotCount) {
  const std::pair<std::function<void(RobotState&)>, const char*> cases[] = {
      {[](RobotState& state) { state.robot_mode = RobotMode::kPowerOff; }, "robot mode POWER_OFF"},
      {[](RobotState& state) { state.robot_status_bits = kStatusTeachButton; }, "teach button"},
      {[](RobotState& state) { state.runtime_state = RuntimeState::kPlaying; },
       "another program runs"},
      {[](RobotState& state) { state.safety_mode = SafetyMode::kFault; }, "safety mode FAULT"}};
  for (const auto& [told, says] : cases) {
    Bench bench(1);
    bench.cell.during_exposure = [&bench, &told = told] { bench.cell.told = told; };
    const AcquisitionResult result = bench.run();
    EXPECT_EQ(result.accepted, 0) << says;
    EXPECT_EQ(result.cause, AcquisitionCause::kRobot);
    EXPECT_THAT(result.text, HasSubstr(says));
    EXPECT_EQ(result.end, AcquisitionEnd::kStopped);
    EXPECT_EQ(bench.cell.motions, 2) << "the way to the first view alone";
  }
}

// Somebody's program, or a hand.
TEST(Acquire, APictureDuringWhichALightWasSwitchedDoesNotCount) {
  Bench bench(1);
  bench.cell.during_exposure = [&bench] { bench.cell.on.insert("bar"); };
  const AcquisitionResult result = bench.run();
  EXPECT_EQ(result.accepted, 0);
  EXPECT_EQ(result.rejected, 0);
  EXPECT_EQ(result.cause, AcquisitionCause::kLight);
  EXPECT_THAT(result.text, HasSubstr("light bar was on"));
  EXPECT_EQ(result.end, AcquisitionEnd::kBackedOut);
}

// Nothing is waited for that does not come by itself.
TEST(Acquire, TellsWhyAnArmIsNotMovedAtTheBeginning) {
  Bench bench(1);
  bench.cell.told = [](RobotState& state) { state.robot_mode = RobotMode::kIdle; };
  const AcquisitionResult result = bench.run();
  EXPECT_EQ(result.cause, AcquisitionCause::kRobot);
  EXPECT_EQ(result.text, "robot mode IDLE");
  EXPECT_EQ(bench.cell.motions, 0);
}

}  // namespace
}  // namespace glint
