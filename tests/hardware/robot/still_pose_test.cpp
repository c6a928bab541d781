// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/still_pose.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/hardware/robot/cell_robot_settings.h"

namespace glint {
namespace {

RobotState still_state(int package, double rate_hz) {
  RobotState state;
  state.timestamp_s = package / rate_hz;
  state.actual_q_rad = test_start_rad();
  state.target_q_rad = test_start_rad();
  state.base_from_tcp.translation() = Eigen::Vector3d(100.0, 200.0, package % 2 == 0 ? 0.1 : -0.1);
  state.robot_mode = RobotMode::kRunning;
  state.safety_mode = SafetyMode::kNormal;
  return state;
}

/// Packages until the rule is content; 0: not within 200.
int packages_needed(double rate_hz) {
  StillPoseRule rule;
  for (int i = 0; i < 200; ++i) {
    rule.add(still_state(i, rate_hz));
    if (rule.pose()) {
      return i + 1;
    }
  }
  return 0;
}

// 25 packages at 125 Hz are 0.192 s; at 500 Hz 0.1 s are 50 periods, so 51 packages.
TEST(StillPoseRule, NeedsPackagesAndTime) {
  EXPECT_EQ(packages_needed(125.0), 25);
  EXPECT_EQ(packages_needed(500.0), 51);
}

TEST(StillPoseRule, NeedsNumbers) {
  for (const bool is_speed : {true, false}) {
    StillPoseRule rule;
    for (int i = 0; i < 200; ++i) {
      RobotState state = still_state(i, 125.0);
      (is_speed ? state.actual_qd_rad_s : state.target_q_rad)[3] = std::nan("");
      EXPECT_FALSE(state.is_still() && is_speed);
      rule.add(state);
    }
    EXPECT_FALSE(rule.pose().has_value());
  }
}

TEST(StillPoseRule, TellsTheMean) {
  StillPoseRule rule;
  for (int i = 0; i < 30; ++i) {
    rule.add(still_state(i, 125.0));
  }
  const auto pose = rule.pose();
  ASSERT_TRUE(pose.has_value());
  EXPECT_EQ(pose->packages, 30);
  EXPECT_NEAR(pose->base_from_tcp.translation().z(), 0.0, 1e-12);
  EXPECT_NEAR(pose->joints_rad[1], test_start_rad()[1], 1e-12);
  EXPECT_LT((pose->base_from_tcp.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(StillPoseRule, BeginsAnewWhenSomethingMovesOrStampsStandStill) {
  using Change = void (*)(RobotState&);
  const Change changes[] = {
      [](RobotState& state) { state.actual_qd_rad_s[3] = 2e-3; },
      [](RobotState& state) { state.actual_q_rad[0] += 2e-4; },
      [](RobotState& state) { state.safety_mode = SafetyMode::kProtectiveStop; },
      [](RobotState& state) { state.runtime_state = RuntimeState::kPlaying; },
      [](RobotState& state) { state.robot_mode = RobotMode::kPowerOff; },
      [](RobotState& state) { state.robot_mode = RobotMode::kIdle; },
      [](RobotState& state) { state.robot_status_bits = kStatusTeachButton; },
      [](RobotState& state) { state.timestamp_s = 0.0; }};
  for (const Change change : changes) {
    StillPoseRule rule;
    for (int i = 0; i < 24; ++i) {
      rule.add(still_state(i, 125.0));
    }
    RobotState broken = still_state(24, 125.0);
    change(broken);
    rule.add(broken);
    rule.add(still_state(25, 125.0));
    EXPECT_FALSE(rule.pose().has_value());
  }
}

}  // namespace
}  // namespace glint
