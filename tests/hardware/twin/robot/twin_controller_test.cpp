// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/twin_controller.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hardware/robot/trapezoid.h"
#include "tests/hardware/robot/cell_robot_settings.h"
#include "tests/hardware/twin/robot/twin_harness.h"

namespace glint {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

void run(TwinController& twin, const std::string& line) {
  ScriptReader reader;
  twin.run(*reader.add_line(line));
}

void run_program(TwinController& twin, std::initializer_list<const char*> lines) {
  ScriptReader reader;
  for (const char* line : lines) {
    if (const auto result = reader.add_line(line)) {
      twin.run(*result);
    }
  }
}

std::int32_t register_0(const TwinController& twin) {
  return std::get<std::int32_t>(*twin.outputs().value_of("output_int_register_0"));
}

void step(TwinController& twin, double duration_s) {
  double t = 0.0;
  while (t < duration_s) {
    twin.step(1.0 / twin.rate_hz());
    t += 1.0 / twin.rate_hz();
  }
}

// Joint 1 by 1 rad at 0.5 rad/s and 1 rad/s2: 0.5 s up, 1.5 s along, 0.5 s down; half way at 1.25
// s.
TEST(TwinController, MovesInATrapezoid) {
  TwinController twin(test_twin(ArmModel::kUr3));
  run(twin,
      "movej([1, -1.7453292519943295, 1.7453292519943295, -1.5707963267948966, "
      "-1.5707963267948966, 0], a=1, v=0.5)");
  step(twin, 1.25 + 0.008);
  EXPECT_NEAR(twin.view().joints_rad[0], 0.5, 0.5 * 0.009);
  EXPECT_FALSE(twin.view().is_still);
  ASSERT_TRUE(twin.view().goal_rad.has_value());
  EXPECT_NEAR((*twin.view().goal_rad)[0], 1.0, 1e-12);
  step(twin, 1.4);
  EXPECT_TRUE(twin.view().is_still);
  EXPECT_NEAR(twin.view().joints_rad[0], 1.0, 1e-12);
}

// Where a line ends has to be known before it begins, to the last bit.
TEST(TwinController, LinesWaitForTheirPictureToo) {
  TwinSettings settings = test_twin(ArmModel::kUr3);
  settings.holds_motions = true;
  TwinController twin(settings);
  const Eigen::Isometry3d at = settings.arm.forward(test_start_rad()) * settings.flange_from_tcp;
  const JointVector six = pose_difference(at, Eigen::Isometry3d::Identity());
  run(twin,
      fmt::format("movel(p[{}, {}, {}, {}, {}, {}], a=0.5, v=0.1)",
                  1e-3 * six[0],
                  1e-3 * (six[1] + 40.0),
                  1e-3 * six[2],
                  six[3],
                  six[4],
                  six[5]));
  step(twin, 1.0);
  ASSERT_TRUE(twin.view().is_held);
  ASSERT_TRUE(twin.view().goal_rad.has_value());
  const JointVector goal_rad = *twin.view().goal_rad;
  EXPECT_LT((twin.view().joints_rad - test_start_rad()).norm(), 1e-4);
  twin.hold_motion(false);
  step(twin, 2.0);
  EXPECT_TRUE(twin.view().is_still);
  EXPECT_EQ(twin.view().joints_rad, goal_rad);
  EXPECT_GT((goal_rad - test_start_rad()).norm(), 0.05);
}

TEST(TwinController, MotionWaitsWhileItIsHeldAndTheClockAlmost) {
  TwinController twin(test_twin(ArmModel::kUr3));
  run(twin, "movej([1, -1.7, 1.7, -1.5, -1.5, 0], a=1, v=0.5)");
  step(twin, 0.5);
  twin.hold_motion(true);
  const JointVector held_rad = twin.view().joints_rad;
  const double time_s = twin.view().time_s;
  step(twin, 1.0);
  EXPECT_EQ(twin.view().joints_rad, held_rad);
  EXPECT_GT(twin.view().time_s, time_s);
  EXPECT_NEAR(twin.view().time_s, time_s + 1e-3, 1e-4);
  twin.hold_motion(false);
  step(twin, 4.0);
  EXPECT_TRUE(twin.view().is_still);
}

// The product looks for a register that changes: pictures may take long.
TEST(TwinController, ThreadsGoOnWhileAMotionWaits) {
  TwinController twin(test_twin(ArmModel::kUr3));
  run_program(twin,
              {"def prog():",
               "  thread beat():",
               "    while True:",
               "      write_output_integer_register(0, 1)",
               "      sleep(0.02)",
               "      write_output_integer_register(0, 2)",
               "      sleep(0.02)",
               "    end",
               "  end",
               "  b = run beat()",
               "  movej([1, -1.7, 1.7, -1.5, -1.5, 0], a=1, v=0.5)",
               "end"});
  step(twin, 0.5);
  twin.hold_motion(true);
  int changes = 0;
  for (std::int32_t last = register_0(twin), i = 0; i < 50; ++i) {
    twin.step(8.0);  // a thousandth of it, as the clock goes meanwhile
    changes += register_0(twin) != last ? 1 : 0;
    last = register_0(twin);
  }
  EXPECT_NEAR(changes, 16, 4);
}

TEST(TwinController, HoldsEachMotionAtItsStartWhenToldTo) {
  TwinSettings settings = test_twin(ArmModel::kUr3);
  settings.holds_motions = true;
  TwinController twin(settings);
  const JointVector start_rad = twin.view().joints_rad;
  run(twin, "movej([1, -1.7, 1.7, -1.5, -1.5, 0], a=1, v=0.5)");
  step(twin, 5.0);
  EXPECT_TRUE(twin.view().is_held);
  EXPECT_EQ(twin.view().joints_rad, start_rad);
  ASSERT_TRUE(twin.view().goal_rad.has_value());
  twin.hold_motion(false);
  step(twin, 5.0);
  EXPECT_NEAR(twin.view().joints_rad[0], 1.0, 1e-12);
  run(twin, "movej([0, -1.7, 1.7, -1.5, -1.5, 0], a=1, v=0.5)");
  step(twin, 1.0);
  run(twin, "stopj(2)");  // another program takes its place, and is not held
  step(twin, 0.1);
  EXPECT_TRUE(twin.view().is_still);
  EXPECT_FALSE(twin.is_program_running());
}

TEST(TwinController, AThreadRunsBesideItsProgramUntilThatEnds) {
  TwinController twin(test_twin(ArmModel::kUr3));
  run_program(twin,
              {"def prog():",
               "  thread beat():",
               "    while True:",
               "      write_output_integer_register(0, 1)",
               "      sleep(0.05)",
               "      write_output_integer_register(0, 2)",
               "      sleep(0.05)",
               "      movej([0, 0, 0, 0, 0, 0])",
               "    end",
               "  end",
               "  b = run beat()",
               "  sleep(1)",
               "  kill b",
               "  write_output_integer_register(0, 3)",
               "  sleep(1)",
               "  c = run beat()",
               "  sleep(0.02)",
               "end"});
  int changes = 0;
  for (std::int32_t last = 0; twin.view().time_s < 0.99; last = register_0(twin)) {
    twin.step(0.008);
    changes += register_0(twin) != last ? 1 : 0;
  }
  EXPECT_NEAR(changes, 18, 2);  // each sleep ends with the cycle after it
  step(twin, 0.5);
  EXPECT_EQ(register_0(twin), 3) << "killed";
  step(twin, 1.0);
  EXPECT_FALSE(twin.is_program_running());
  EXPECT_EQ(register_0(twin), 1) << "ended with its program";
  EXPECT_EQ(twin.view().joints_rad, test_start_rad()) << "a thread moves nothing";
  run_program(twin, {"def prog():", "  b = run nothing()", "end"});
  step(twin, 0.1);
  EXPECT_THAT(twin.take_messages().back().text, HasSubstr("no such thread"));
}

// The motion that was broken off is made to its end, and what follows it after that.
TEST(TwinController, ASafeguardStopPausesAProgramUntilItIsReset) {
  for (const bool is_stopped : {false, true}) {
    TwinController twin(test_twin(ArmModel::kUr3));
    run_program(twin,
                {"def prog():",
                 "  movej([1, -1.7, 1.7, -1.5, -1.5, 0], a=1, v=0.5)",
                 "  write_output_integer_register(0, 5)",
                 "end"});
    step(twin, 1.0);
    twin.add_fault({.kind = FaultKind::kSafeguardStop});
    step(twin, 1.0);
    EXPECT_EQ(twin.reply("programState"), "PAUSED prog");
    EXPECT_TRUE(twin.view().is_still);
    const JointVector at_rad = twin.view().joints_rad;
    step(twin, 1.0);
    EXPECT_EQ(twin.view().joints_rad, at_rad);
    if (is_stopped) {
      EXPECT_EQ(twin.reply("stop"), "Stopped");
      EXPECT_EQ(twin.reply("programState"), "STOPPED <unnamed>");
    }
    twin.add_fault({.kind = FaultKind::kRelease});
    step(twin, 5.0);
    EXPECT_EQ(twin.view().joints_rad == at_rad, is_stopped);
    EXPECT_EQ(register_0(twin), is_stopped ? 0 : 5);
    EXPECT_FALSE(twin.is_program_running());
  }
}

TEST(TwinController, UnlocksAProtectiveStopAfterFiveSeconds) {
  TwinController twin(test_twin(ArmModel::kUr3e));
  twin.add_fault({.kind = FaultKind::kProtectiveStop});
  step(twin, 0.1);
  EXPECT_EQ(twin.reply("safetymode"), "Safetymode: PROTECTIVE_STOP");
  EXPECT_THAT(twin.reply("unlock protective stop"), StartsWith("Cannot unlock"));
  step(twin, 5.1);
  EXPECT_EQ(twin.reply("unlock protective stop"), "Protective stop releasing");
  EXPECT_EQ(twin.reply("safetymode"), "Safetymode: NORMAL");
}

TEST(TwinController, NeedsPowerAndBrakesAfterAnEmergencyStop) {
  TwinController twin(test_twin(ArmModel::kUr3));
  twin.add_fault({.kind = FaultKind::kEmergencyStop});
  step(twin, 1.0);
  EXPECT_EQ(twin.robot_mode(), RobotMode::kPowerOff);
  EXPECT_THAT(twin.reply("power on"), HasSubstr("Failed"));
  twin.add_fault({.kind = FaultKind::kRelease});
  step(twin, 0.1);
  EXPECT_THAT(twin.reply("brake release"), HasSubstr("Failed"));
  EXPECT_EQ(twin.reply("power on"), "Powering on");
  step(twin, 1.1);
  EXPECT_EQ(twin.robot_mode(), RobotMode::kIdle);
  EXPECT_EQ(twin.reply("brake release"), "Brake releasing");
  step(twin, 1.0);
  EXPECT_EQ(twin.robot_mode(), RobotMode::kRunning);
}

TEST(TwinController, DashboardAnswersEveryLine) {
  TwinController twin(test_twin(ArmModel::kUr3));
  EXPECT_EQ(twin.reply("robotmode"), "Robotmode: RUNNING");
  EXPECT_EQ(twin.reply("running"), "Program running: false");
  EXPECT_EQ(twin.reply("get robot model"), "UR3");
  EXPECT_THAT(twin.reply("PolyscopeVersion"), StartsWith("URSoftware 3."));
  EXPECT_THAT(twin.reply("jump"), StartsWith("could not understand"));
  EXPECT_THAT(twin.reply("is in remote control"), StartsWith("could not understand"));
  EXPECT_THAT(twin.reply("play"), StartsWith("Failed to execute"));
  EXPECT_EQ(TwinController(test_twin(ArmModel::kUr3e)).reply("is in remote control"), "true");
}

TEST(TwinController, ProgramsThatFailTellWhy) {
  const auto message_of = [](const std::string& line) {
    TwinController twin(test_twin(ArmModel::kUr3));
    run(twin, line);
    step(twin, 20.0);
    const std::vector<PrimaryMessage> messages = twin.take_messages();
    EXPECT_FALSE(twin.is_program_running());
    return messages.empty() ? std::string() : messages.back().text;
  };
  EXPECT_THAT(message_of("movej(p[3, 0, 0, 0, 0, 0])"), HasSubstr("inverse kin"));
  EXPECT_THAT(message_of("movej([7, 0, 0, 0, 0, 0])"), HasSubstr("joint limit"));
  EXPECT_THAT(message_of("movel(p[3, 0, 0.2, 0, 0, 0])"), HasSubstr("singular"));
  EXPECT_THAT(message_of("fly(1)"), HasSubstr("compile error"));
  EXPECT_THAT(message_of("set_digital_out(99, True)"), HasSubstr("out of range"));
  EXPECT_EQ(message_of("sleep(0.1)"), "");
}

TEST(TwinController, ASecondaryProgramRunsBesideAndMovesNothing) {
  TwinController twin(test_twin(ArmModel::kUr3));
  ScriptReader reader;
  reader.add_line("sec light():");
  reader.add_line("  set_standard_digital_out(2, True)");
  reader.add_line("  movej([1, 0, 0, 0, 0, 0])");
  twin.run(*reader.add_line("end"));
  step(twin, 1.0);
  EXPECT_EQ(twin.view().digital_outputs, 4U);
  EXPECT_EQ(twin.view().joints_rad, test_start_rad());
}

TEST(ParseFault, ReadsKindMomentAndDelay) {
  const auto fault = parse_fault("protective_stop moving 0.3");
  ASSERT_TRUE(fault.has_value());
  EXPECT_EQ(fault->kind, FaultKind::kProtectiveStop);
  EXPECT_EQ(fault->when, Fault::When::kMoving);
  EXPECT_EQ(fault->delay_s, 0.3);
  for (const char* text : {"",
                           "fire",
                           "silence later",
                           "silence now x",
                           "silence now -1",
                           "silence now 1 2",
                           "silence now 1e9"}) {
    EXPECT_FALSE(parse_fault(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace glint
