// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the dashboard of an e-Series says of remote control, and what becomes of a motion then.
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hardware/robot/ur_robot.h"
#include "tests/hardware/twin/robot/robot_of_twin.h"
#include "tests/support/loopback_listener.h"

namespace glint {
namespace {

using testing::HasSubstr;

/// A dashboard that answers every line alike, or, where the answer is empty, by hanging up.
class OneAnswerDashboard {
 public:
  explicit OneAnswerDashboard(std::string answer)
      : answer_(std::move(answer)), thread_([this] { serve(); }) {}

  ~OneAnswerDashboard() {
    listener_.shut_down();
    thread_.join();
  }

  OneAnswerDashboard(const OneAnswerDashboard&) = delete;
  OneAnswerDashboard& operator=(const OneAnswerDashboard&) = delete;

  int port() const { return listener_.port(); }

 private:
  void serve() const {
    const std::string greeting = "Connected: Universal Robots Dashboard Server\n";
    for (int peer = listener_.accept(2000); peer >= 0; peer = listener_.accept(2000)) {
      ::send(peer, greeting.data(), greeting.size(), MSG_NOSIGNAL);
      std::array<char, 256> bytes = {};
      while (::recv(peer, bytes.data(), bytes.size(), 0) > 0 && !answer_.empty()) {
        ::send(peer, answer_.data(), answer_.size(), MSG_NOSIGNAL);
      }
      ::close(peer);
    }
  }

  std::string answer_;
  LoopbackListener listener_;
  std::thread thread_;  // last: uses the others
};

/// What is said when motion is allowed at a UR3e whose dashboard answers so.
std::string problem_with(const std::string& answer) {
  const TwinServer server(on_free_ports(ArmModel::kUr3e));
  const OneAnswerDashboard dashboard(answer);
  UrSettings settings = settings_for(server, ArmModel::kUr3e);
  settings.dashboard_port = dashboard.port();
  UrRobot robot(settings, arm_with_tool(settings, test_limits()));
  try {
    robot.allow_motion(MotionPermit::from_command_line(true, "test"));
  } catch (const std::exception& error) {
    EXPECT_EQ(server.num_command_bytes(), 0U);
    return error.what();
  }
  return "allowed";
}

// Neither an answer that is none nor silence means that it is off.
TEST(RemoteControl, IsOffOnlyWhereTheDashboardSaysSo) {
  EXPECT_EQ(problem_with("true\n"), "allowed");
  EXPECT_THAT(problem_with("false\n"), HasSubstr("remote control is off"));
  for (const char* answer : {"could not understand: \"is in remote control\"\n", "\n", "1\n"}) {
    EXPECT_THAT(problem_with(answer), HasSubstr("does not tell whether remote control is on"))
        << answer;
  }
  const std::string silent = problem_with("");
  EXPECT_THAT(silent, HasSubstr("closed (asked whether remote control is on)"));
}

TEST(RemoteControl, IsAskedForBeforeEachMotion) {
  TwinServer server(on_free_ports(ArmModel::kUr3e));
  const UrSettings settings = settings_for(server, ArmModel::kUr3e);
  UrRobot robot(settings, arm_with_tool(settings, test_limits()));
  robot.allow_motion(MotionPermit::from_command_line(true, "test"));
  server.add_fault({.kind = FaultKind::kRemoteOff});
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const JointVector goal_rad = test_start_rad() + JointVector{0.3, 0.05, -0.1, 0.0, 0.1, 0.2};
  const MotionResult result = robot.move_joints(goal_rad, 1.0);
  EXPECT_EQ(result.outcome, MotionOutcome::kRefused);
  EXPECT_THAT(result.text, HasSubstr("remote control is off"));
}

}  // namespace
}  // namespace glint
