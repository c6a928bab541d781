// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a controller's bytes do to the driver, without a twin.
#include "hardware/robot/ur_driver.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hardware/robot/cell_robot_settings.h"

namespace glint {
namespace {

using testing::HasSubstr;
using testing::Not;

std::array<double, 6> six_of(const JointVector& vector) {
  std::array<double, 6> values = {};
  Eigen::Map<JointVector>(values.data()) = vector;
  return values;
}

/// Metres and a rotation vector.
std::array<double, 6> six_of(const Eigen::Isometry3d& pose) {
  JointVector six = pose_difference(pose, Eigen::Isometry3d::Identity());
  six.head<3>() *= 1e-3;
  return six_of(six);
}

/// A driver that streams from a controller whose arm stands ready.
struct DriverBench {
  DriverBench() {
    driver.allow_motion(MotionPermit::from_command_line(true, "test"));
    std::vector<std::string> types;
    for (const auto& names : {state_outputs(settings.ack_register), newer_outputs()}) {
      for (const std::string& name : names) {
        types.emplace_back(name_of(output_type(name).value()));
      }
    }
    driver.on_rtde(flag_reply(RtdeKind::kProtocolVersion, true) +
                       controller_version_reply({.major = 5, .minor = 11, .bugfix = 4}) +
                       recipe_reply(RtdeKind::kOutputs, {1, types}) +
                       flag_reply(RtdeKind::kStart, true) + package(1.0),
                   0.0);
  }

  /// In the order of state_outputs() and newer_outputs().
  std::string package(double stamp_s, const JointVector& joints_rad = test_start_rad()) const {
    return data_package(1,
                        {stamp_s,
                         six_of(joints_rad),
                         six_of(joints_rad),
                         six_of(JointVector(JointVector::Zero())),
                         six_of(driver.arm().base_from_tcp(test_start_rad())),
                         six_of(JointVector(JointVector::Zero())),
                         static_cast<std::int32_t>(RobotMode::kRunning),
                         static_cast<std::int32_t>(SafetyMode::kNormal),
                         static_cast<std::uint32_t>(RuntimeState::kStopped),
                         kStatusPowerOn,
                         safety_status_bits(SafetyMode::kNormal),
                         1.0,
                         std::uint64_t{0},
                         std::int32_t{0},
                         six_of(driver.arm().flange_from_tcp),
                         settings.payload_kg,
                         std::array<double, 3>{0.0, 0.0, 0.04},
                         1.0});
  }

  /// A motion that has gone out.
  void begin() {
    const JointVector goal_rad = test_start_rad() + JointVector{0.5, 0.0, 0.0, 0.0, 0.0, 0.0};
    ASSERT_FALSE(
        driver.begin(check_joint_motion(driver.arm(), test_start_rad(), goal_rad, 1.0), 0.0)
            .has_value());
    ASSERT_THAT(driver.take_script_output(), HasSubstr("movej"));
  }

  UrSettings settings = test_robot(ArmModel::kUr3e);
  UrDriver driver{settings, arm_with_tool(settings, test_limits())};
};

TEST(UrDriver, IsReadyToMoveByTheBytesOfOnePackage) {
  const DriverBench bench;
  EXPECT_EQ(bench.driver.refusal(0.0).value_or(MotionResult{}).text, "");
}

TEST(UrDriver, ReadsAPackageThatIsCutAnywhere) {
  const std::string package = DriverBench().package(1.002);
  for (std::size_t cut = 0; cut <= package.size(); ++cut) {
    DriverBench bench;
    bench.driver.on_rtde(std::string_view(package).substr(0, cut), 0.002);
    EXPECT_EQ(bench.driver.state(0.002)->timestamp_s, cut < package.size() ? 1.0 : 1.002);
    bench.driver.on_rtde(std::string_view(package).substr(cut), 0.003);
    EXPECT_EQ(bench.driver.state(0.003)->timestamp_s, 1.002);
    EXPECT_FALSE(bench.driver.halted().has_value());
  }
}

// It tells nothing of now.
TEST(UrDriver, AStampThatIsNoNumberIsNoNewPackage) {
  DriverBench bench;
  double now_s = 0.0;
  while (now_s < 0.3) {
    bench.driver.on_rtde(bench.package(std::nan("")), now_s);
    bench.driver.on_time(now_s);
    now_s += 0.002;
  }
  ASSERT_TRUE(bench.driver.halted().has_value());
  EXPECT_EQ(bench.driver.halted()->outcome, MotionOutcome::kLost);
  EXPECT_THAT(bench.driver.halted()->text, HasSubstr("no new package"));
}

TEST(UrDriver, JointsThatAreNoNumbersAreNeitherMovedNorAPose) {
  for (const double strange : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    DriverBench bench;
    JointVector joints_rad = test_start_rad();
    joints_rad[3] = strange;
    for (int i = 1; i < 100; ++i) {
      bench.driver.on_rtde(bench.package(1.0 + 0.002 * i, joints_rad), 0.002 * i);
    }
    EXPECT_FALSE(bench.driver.still_pose().has_value());
    EXPECT_THAT(bench.driver.refusal(0.2).value_or(MotionResult{}).text, HasSubstr("unknown"));
  }
}

// What the reader of UrRobot is thrown, and does then.
TEST(UrDriver, GarbledBytesInAMotionEndItInAStop) {
  const std::string garbled[] = {std::string("\x00\x01U", 3),
                                 rtde_package(RtdeKind::kData, std::string(8, '\1')),
                                 rtde_package(RtdeKind::kText, "\xff"),
                                 rtde_package(RtdeKind::kOutputs, "\1DOUBLE")};
  for (const std::string& bytes : garbled) {
    DriverBench bench;
    bench.begin();
    EXPECT_THROW(bench.driver.on_rtde(bytes, 0.1), ProtocolError);
    bench.driver.on_rtde_closed("RTDE");
    const std::string script = bench.driver.take_script_output();
    EXPECT_THAT(script, HasSubstr("stopj"));
    EXPECT_THAT(script, Not(HasSubstr("movej")));
    bench.driver.on_time(0.2);
    ASSERT_TRUE(bench.driver.result().has_value());
    EXPECT_EQ(bench.driver.result()->outcome, MotionOutcome::kLost);
    EXPECT_THAT(bench.driver.result()->text, HasSubstr("RTDE: "));
  }
}

}  // namespace
}  // namespace glint
