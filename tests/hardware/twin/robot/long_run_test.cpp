// SPDX-License-Identifier: GPL-3.0-or-later
//
// Hours of protocol time, and many faults over the wire.
#include <chrono>
#include <iostream>
#include <thread>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/wall_clock.h"
#include "hardware/robot/rtde_client.h"
#include "hardware/robot/tcp_link.h"
#include "hardware/robot/ur_robot.h"
#include "hardware/twin/robot/twin_server.h"
#include "tests/hardware/robot/cell_robot_settings.h"
#include "tests/hardware/twin/robot/twin_harness.h"
#include "tests/support/resident_memory.h"

namespace glint {
namespace {

TEST(LongRun, ADayOnTheInjectedClockTakesNoMemory) {
  TwinHarness harness(ArmModel::kUr3);
  harness.run(600.0);
  const double before_mb = resident_mb();
  for (int hour = 0; hour < 24; ++hour) {
    JointVector goal_rad = test_start_rad();
    goal_rad[0] += hour % 2 == 0 ? 0.3 : 0.0;
    ASSERT_TRUE(harness.move(goal_rad)->is_done());
    harness.run(3600.0);
  }
  EXPECT_GT(harness.now_s(), 24.0 * 3600.0);
  EXPECT_LT(resident_mb() - before_mb, 5.0);
}

TEST(LongRun, AnHourOfPackagesOverTheWireIsCompleteAndTakesNoMemory) {
  TwinServer server(
      {.twin = test_twin(ArmModel::kUr3), .ports = {0, 0, 0, 0}, .is_as_fast_as_possible = true});
  TcpLink link("127.0.0.1", server.ports().rtde, 2.0);
  RtdeClient client(
      {.outputs = state_outputs(0), .newer = newer_outputs(), .inputs = {}, .rate_hz = 0.0});
  double first_s = 0.0;
  double last_s = 0.0;
  double before_mb = 0.0;
  std::uint64_t gaps = 0;
  while (client.num_packages() < 3600 * 125 + 1) {
    if (const std::string output = client.take_output(); !output.empty()) {
      link.write(output, 1.0);
    }
    client.feed(link.read(1.0), [&] {
      const double stamp_s = client.get<double>("timestamp");
      gaps += client.num_packages() > 1 && std::abs(stamp_s - last_s - 0.008) > 1e-6 ? 1U : 0U;
      first_s = client.num_packages() == 1 ? stamp_s : first_s;
      last_s = stamp_s;
      if (client.num_packages() == 10000) {
        before_mb = resident_mb();
      }
    });
  }
  EXPECT_EQ(gaps, 0U);
  // Packages that came glued to the last one are counted, too. Sums of 8 ms are rounded.
  EXPECT_GT(last_s - first_s, 3600.0 - 1e-3);
  EXPECT_NEAR(last_s - first_s, 0.008 * static_cast<double>(client.num_packages() - 1), 1e-3);
  EXPECT_LT(resident_mb() - before_mb, 5.0);
}

/// How long after a stop the arm may still be slowing down: half a second until the stop is sent,
/// and as long from the highest speed to none.
constexpr std::chrono::milliseconds kUntilStill(1000);

/// After a stop the arm stands still, and whoever moves it is told the stop again: nothing is sent.
void expect_no_motion(TwinServer& server, UrRobot& robot) {
  std::this_thread::sleep_for(kUntilStill);
  const JointVector at_rad = server.view().joints_rad;
  const std::uint64_t sent = server.num_command_bytes();
  EXPECT_TRUE(is_stop(robot.move_joints(test_start_rad(), 1.0).outcome));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(server.view().joints_rad, at_rad);
  EXPECT_EQ(server.num_command_bytes(), sent);
}

/// The base turns by 1.6 rad or more, to one side and back. Faults come to act 1.5 s after the arm
/// has begun to move at the latest: it would be on its way for seconds after any of them.
JointVector far_goal_rad(int motion, Rng& rng) {
  JointVector goal_rad = test_start_rad();
  for (double& angle : goal_rad) {
    angle += rng.uniform(-0.3, 0.3);
  }
  goal_rad[0] += motion % 2 == 0 ? 2.2 : 0.0;
  return goal_rad;
}

/// Up to three motions, each with up to two faults, until one of them is stopped.
/// @return what became of the motions
std::string run_wire_sequence(std::uint64_t seed) {
  Rng rng(seed, Stream::kTest, 9);
  const ArmModel model = seed % 2 == 0 ? ArmModel::kUr3 : ArmModel::kUr3e;
  TwinServer server({.twin = test_twin(model), .ports = {0, 0, 0, 0}});
  UrSettings settings = test_robot(model);
  settings.rtde_port = server.ports().rtde;
  settings.primary_port = server.ports().primary;
  settings.secondary_port = server.ports().secondary;
  settings.dashboard_port = server.ports().dashboard;
  UrRobot robot(settings, arm_with_tool(settings, test_limits()));
  robot.allow_motion(MotionPermit::from_command_line(true, "test"));
  std::string outcomes;
  for (int motion = 0; motion < 3; ++motion) {
    for (int k = 0; k < 2; ++k) {
      if (rng.uniform() < 0.5) {
        server.add_fault(random_fault(rng));
      }
    }
    const JointVector goal_rad = far_goal_rad(motion, rng);
    const auto start = std::chrono::steady_clock::now();
    const MotionResult result = robot.move_joints(goal_rad, 1.0);
    EXPECT_LT(seconds_since(start), 20.0) << result.text;
    outcomes += std::string(name_of(result.outcome)) + " ";
    if (is_stop(result.outcome)) {
      expect_no_motion(server, robot);
      break;
    }
  }
  return outcomes;
}

TEST(LongRun, FiftySequencesOfFaultsOverTheWireEachHaveTheirResults) {
  int arrived = 0;
  int stopped = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    const std::string outcomes = run_wire_sequence(seed);
    std::cout << seed << ": " << outcomes << "\n";
    arrived += outcomes.find("done") != std::string::npos ? 1 : 0;
    stopped +=
        outcomes.find("stop") != std::string::npos || outcomes.find("lost") != std::string::npos
            ? 1
            : 0;
  }
  EXPECT_GT(arrived, 5);
  EXPECT_GT(stopped, 15);
}

}  // namespace
}  // namespace glint
