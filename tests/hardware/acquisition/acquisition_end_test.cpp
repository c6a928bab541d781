// SPDX-License-Identifier: GPL-3.0-or-later
//
// How an acquisition ends that has nothing to take, waits for a person, or is in a reduced mode.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "hardware/acquisition/acquisition.h"
#include "tests/hardware/acquisition/bench.h"
#include "tests/hardware/acquisition/fake_cell.h"

namespace glint {
namespace {

using testing::HasSubstr;

// All pictures are there, and the session that took them was ended before it could tell so.
TEST(Acquire, WithNothingToTakeOnlyBringsTheArmToTheNearestSafePoint) {
  struct Case {
    JointVector start;
    int motions;
    AcquisitionEnd end;
  };

  for (const Case& one : {Case{joints(0, 0), 0, AcquisitionEnd::kTour},
                          Case{joints(1.0, 0.5), 1, AcquisitionEnd::kTour},
                          Case{joints(0.5, 0.1), 2, AcquisitionEnd::kBackedOut},
                          Case{joints(0.25, 0), 1, AcquisitionEnd::kBackedOut}}) {
    Bench bench(0);
    bench.cell.joints_ = one.start;
    const AcquisitionResult result = bench.run();
    EXPECT_TRUE(result.is_complete()) << result.text;
    EXPECT_EQ(bench.cell.motions, one.motions) << one.start.transpose();
    EXPECT_EQ(result.end, one.end);
    EXPECT_EQ(result.where, "home");
    EXPECT_EQ(bench.cell.joints_, joints(0, 0));
    EXPECT_TRUE(bench.taken.empty());
  }
}

TEST(Acquire, WithNothingToTakeHeedsTheUserAndTheSafetyMode) {
  Bench interrupted(0);
  interrupted.cell.joints_ = joints(0.5, 0);
  interrupted.cell.interrupt = 1;
  const AcquisitionResult result = interrupted.run();
  EXPECT_EQ(result.cause, AcquisitionCause::kInterrupted);
  EXPECT_EQ(result.end, AcquisitionEnd::kBackedOut);
  Bench reduced(0);
  reduced.cell.joints_ = joints(0.5, 0);
  reduced.cell.safety = SafetyMode::kReduced;
  EXPECT_EQ(reduced.run().cause, AcquisitionCause::kRobot);
  EXPECT_EQ(reduced.cell.motions, 0);
}

// Ctrl-C at the question: it is heard, and nobody is asked for anything on the way back.
TEST(Acquire, IsInterruptedAtAQuestionToAPerson) {
  Bench bench(1);
  int asked = 0;
  PromptedLight lamp("ring", [&](bool, const std::string&) {
    ++asked;
    ++bench.cell.interrupt;
    return false;
  });
  const AcquisitionDevices devices = {
      .robot = bench.robot,
      .camera = bench.camera,
      .lamps = {{.light = &bench.bar}, {.light = &lamp, .is_left_on = true}},
      .stage = &bench.stage,
      .wait = [](double) {}};
  const AcquisitionOptions options = {.interrupt = &bench.cell.interrupt};
  const AcquisitionResult result =
      acquire(bench.plan, devices, options, [](const TakenPicture&) {});
  EXPECT_EQ(result.cause, AcquisitionCause::kInterrupted);
  EXPECT_THAT(result.text, HasSubstr("interrupted by the user"));
  EXPECT_EQ(result.end, AcquisitionEnd::kBackedOut);
  EXPECT_EQ(result.where, "home");
  EXPECT_EQ(asked, 1);
  EXPECT_FALSE(bench.cell.on.contains("bar"));
}

// Nobody says that it is so: that is the cause, and nobody is asked a second time.
TEST(Acquire, EndsAtALightThatNobodySwitches) {
  Bench bench(1);
  int asked = 0;
  PromptedLight lamp("ring", [&asked](bool, const std::string&) {
    ++asked;
    return false;
  });
  const AcquisitionDevices devices = {.robot = bench.robot,
                                      .camera = bench.camera,
                                      .lamps = {{.light = &lamp, .is_left_on = true}},
                                      .stage = &bench.stage,
                                      .wait = [](double) {}};
  const AcquisitionResult result = acquire(bench.plan, devices, {}, [](const TakenPicture&) {});
  EXPECT_EQ(result.cause, AcquisitionCause::kLight);
  EXPECT_EQ(result.text,
            "light ring: nobody confirms that it is on; once it is, the command needs --confirmed "
            "ring=on");
  EXPECT_EQ(asked, 1);
}

TEST(Acquire, DoesNotMoveBackInAReducedSafetyMode) {
  Bench bench(1);
  bench.cell.safety = SafetyMode::kReduced;
  bench.cell.fault = FakeFault::kSink;
  const AcquisitionResult result = bench.run();
  EXPECT_EQ(result.cause, AcquisitionCause::kSink);
  EXPECT_EQ(result.end, AcquisitionEnd::kStopped);
  EXPECT_THAT(result.text, HasSubstr("the way back was not made"));
  EXPECT_EQ(result.where, "left");
}

// At the normal end, too: the last picture is taken, and somebody steps in.
TEST(Acquire, DoesNotGoToTheEndInAReducedSafetyMode) {
  Bench bench(1);
  bench.before_end = [&bench] { bench.cell.safety = SafetyMode::kReduced; };
  const AcquisitionResult result = bench.run();
  EXPECT_EQ(result.accepted, 2);
  EXPECT_EQ(result.cause, AcquisitionCause::kRobot);
  EXPECT_EQ(result.end, AcquisitionEnd::kStopped);
  EXPECT_THAT(result.text, HasSubstr("safety mode REDUCED"));
  EXPECT_EQ(result.where, "right");
}

}  // namespace
}  // namespace glint
