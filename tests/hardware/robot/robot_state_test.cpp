// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/robot_state.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hardware/robot/cell_robot_settings.h"

namespace glint {
namespace {

using testing::HasSubstr;

struct Bench {
  UrSettings settings = test_robot(ArmModel::kUr3e);
  ArmWithTool arm = arm_with_tool(settings, test_limits());
  RobotState state = ready();

  RobotState ready() const {
    RobotState ready;
    ready.actual_q_rad = test_start_rad();
    ready.base_from_tcp = arm.base_from_tcp(test_start_rad());
    ready.robot_mode = RobotMode::kRunning;
    ready.safety_mode = SafetyMode::kNormal;
    ready.tcp_offset = arm.flange_from_tcp;
    ready.payload_kg = 0.6;
    ready.payload_cog_mm = Eigen::Vector3d(0.0, 0.0, 40.0);
    return ready;
  }

  std::string refusal() const { return motion_refusal(state, arm, settings); }
};

TEST(MotionRefusal, IsEmptyForARobotThatIsReady) {
  EXPECT_EQ(Bench().refusal(), "");
}

TEST(MotionRefusal, NamesWhatSpeaksAgainstMotion) {
  struct Case {
    void (*change)(RobotState& state);
    const char* says;
  };

  const Case cases[] = {
      {[](RobotState& s) { s.safety_mode = SafetyMode::kProtectiveStop; }, "PROTECTIVE_STOP"},
      {[](RobotState& s) { s.safety_mode = SafetyMode::kRobotEmergencyStop; },
       "ROBOT_EMERGENCY_STOP"},
      {[](RobotState& s) { s.safety_mode = static_cast<SafetyMode>(77); }, "UNKNOWN"},
      {[](RobotState& s) { s.robot_mode = RobotMode::kIdle; }, "IDLE"},
      {[](RobotState& s) { s.runtime_state = RuntimeState::kPlaying; }, "another program"},
      {[](RobotState& s) { s.runtime_state = RuntimeState::kPaused; }, "another program"},
      {[](RobotState& s) { s.robot_status_bits = kStatusProgramRunning; }, "another program"},
      {[](RobotState& s) { s.robot_status_bits = 1U << 2; }, "teach button"},
      {[](RobotState& s) { s.actual_qd_rad_s[0] = std::nan(""); }, "unknown"},
      {[](RobotState& s) { s.tcp_offset->translation().x() += 0.2; }, "0.20 mm"},
      {[](RobotState& s) { s.payload_kg = 0.7; }, "0.700 kg"},
      {[](RobotState& s) { s.payload_cog_mm->z() = 45.0; }, "5.0 mm"},
      {[](RobotState& s) { s.tcp_offset->translation().z() = std::nan(""); }, "nan mm"},
      {[](RobotState& s) { s.tcp_offset->linear()(1, 1) = std::nan(""); }, "nan degrees"},
      {[](RobotState& s) { s.payload_kg = std::nan(""); }, "nan kg"},
      {[](RobotState& s) { s.payload_cog_mm->y() = std::nan(""); }, "nan mm"},
      {[](RobotState& s) { s.safety_mode = SafetyMode::kRecovery; }, "RECOVERY"},
      {[](RobotState& s) { s.safety_mode = SafetyMode::kViolation; }, "VIOLATION"},
      {[](RobotState& s) { s.safety_mode = SafetyMode::kFault; }, "FAULT"},
      {[](RobotState& s) { s.robot_mode = RobotMode::kPowerOff; }, "POWER_OFF"},
      {[](RobotState& s) { s.robot_mode = RobotMode::kBooting; }, "BOOTING"},
      {[](RobotState& s) { s.payload_kg.reset(); }, "does not report its payload"},
      {[](RobotState& s) { s.actual_q_rad[2] = std::nan(""); }, "unknown"}};
  for (const Case& one : cases) {
    Bench bench;
    one.change(bench.state);
    EXPECT_THAT(bench.refusal(), HasSubstr(one.says));
  }
}

TEST(MotionRefusal, IsEmptyInReducedMode) {
  Bench bench;
  bench.state.safety_mode = SafetyMode::kReduced;
  EXPECT_EQ(bench.refusal(), "");
}

// Without tcp_offset the controller's TCP is known by its pose alone.
TEST(TcpDifference, IsSeenInThePoseOfOlderControllers) {
  Bench bench;
  bench.state.tcp_offset.reset();
  EXPECT_EQ(bench.refusal(), "");
  bench.state.base_from_tcp.translation().y() += 6.0;
  EXPECT_THAT(bench.refusal(), HasSubstr("6.00 mm"));
}

TEST(StopOf, SafetyStatusBitsAgreeWithTheMode) {
  EXPECT_EQ(safety_status_bits(SafetyMode::kNormal), 1U);
  EXPECT_EQ(safety_status_bits(SafetyMode::kProtectiveStop), (1U << 2) | (1U << 10));
  EXPECT_EQ(safety_status_bits(SafetyMode::kRobotEmergencyStop),
            (1U << 6) | (1U << 7) | (1U << 10));
}

}  // namespace
}  // namespace glint
