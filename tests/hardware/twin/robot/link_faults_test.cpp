// SPDX-License-Identifier: GPL-3.0-or-later
//
// What UrRobot's reader makes of a connection that turns bad while the arm moves: the arm is
// stopped, it is told why, and no motion comes later.
#include <array>
#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/wall_clock.h"
#include "hardware/robot/tcp_link.h"
#include "hardware/robot/ur_robot.h"
#include "hardware/twin/robot/twin_server.h"
#include "tests/hardware/robot/cell_robot_settings.h"
#include "tests/hardware/twin/robot/relay.h"
#include "tests/hardware/twin/robot/twin_harness.h"

namespace glint {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Waits, generously. @return it is so
bool comes_true(const std::function<bool()>& condition) {
  const auto start = std::chrono::steady_clock::now();
  while (!condition()) {
    if (seconds_since(start) > 20.0) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

/// A robot that reaches its twin through relays.
struct RelayedRobot {
  RelayedRobot() { robot.allow_motion(MotionPermit::from_command_line(true, "test")); }

  UrSettings settings_through_relays() const {
    UrSettings settings = test_robot(ArmModel::kUr3);
    settings.rtde_port = rtde.port();
    settings.primary_port = primary.port();
    settings.secondary_port = server.ports().secondary;
    settings.dashboard_port = server.ports().dashboard;
    return settings;
  }

  bool has_moved() const { return server.view().joints_rad != test_start_rad(); }

  TwinServer server{
      {.twin = test_twin(ArmModel::kUr3), .address = "127.0.0.1", .ports = {0, 0, 0, 0}}};
  Relay rtde{server.ports().rtde};
  Relay primary{server.ports().primary, Relay::Way::kThereAlone};
  UrRobot robot{settings_through_relays(), arm_with_tool(settings_through_relays(), test_limits())};
};

/// Some seconds away.
JointVector distant_rad() {
  return test_start_rad() + JointVector{1.8, 0.05, -0.1, 0.0, 0.1, 0.2};
}

/// A motion during which something is done.
MotionResult moved_while(RelayedRobot& relayed, const std::function<void()>& disturb) {
  const std::jthread other([&] {
    EXPECT_TRUE(comes_true([&] { return relayed.has_moved(); }));
    disturb();
  });
  return relayed.robot.move_joints(distant_rad(), 1.0);
}

void expect_stopped_on_its_way(RelayedRobot& relayed) {
  EXPECT_TRUE(comes_true([&] { return relayed.server.view().is_still; }));
  EXPECT_GT((relayed.server.view().joints_rad - distant_rad()).norm(), 0.1);
  const std::size_t connections = relayed.primary.num_connections();
  EXPECT_THAT(relayed.primary.received(connections - 1), HasSubstr("stopj"));
  const MotionResult again = relayed.robot.move_joints(distant_rad(), 1.0);
  EXPECT_EQ(name_of(again.outcome), "lost") << "nothing moves it any more";
}

// A length below that of a head: what follows cannot be read any more.
TEST(UrRobot, AGarbledPackageInMotionStopsTheArmAndIsTold) {
  RelayedRobot relayed;
  const MotionResult result =
      moved_while(relayed, [&] { relayed.rtde.inject(std::string_view("\x00\x01U", 3)); });
  EXPECT_EQ(name_of(result.outcome), "lost") << result.text;
  EXPECT_THAT(result.text, HasSubstr("RTDE: "));
  expect_stopped_on_its_way(relayed);
}

// The stop goes out on a new connection.
TEST(UrRobot, AGarbledMessageInMotionStopsTheArmAndIsTold) {
  RelayedRobot relayed;
  const MotionResult result =
      moved_while(relayed, [&] { relayed.primary.inject("\xff\xff\xff\xff\x14"); });
  EXPECT_EQ(name_of(result.outcome), "lost") << result.text;
  EXPECT_THAT(result.text, HasSubstr("primary interface: "));
  EXPECT_EQ(relayed.primary.num_connections(), 2U);
  expect_stopped_on_its_way(relayed);
}

/// Bytes that wait to be acknowledged on connections of this machine to a port. A line of the
/// table: number, local address and port in hexadecimal, the peer's, state, bytes that wait to be
/// sent and to be read.
unsigned long waiting_for(int port) {
  std::ifstream table("/proc/net/tcp");
  std::string line;
  std::getline(table, line);
  unsigned long bytes = 0;
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::array<std::string, 5> columns;
    for (std::string& column : columns) {
      words >> column;
    }
    if (columns[2] == fmt::format("0100007F:{:04X}", port)) {
      bytes += std::stoul(columns[4].substr(0, columns[4].find(':')), nullptr, 16);
    }
  }
  return bytes;
}

// The cable is out when the motion is sent, and somebody wants it to end.
TEST(UrRobot, AMotionThatIsNotDeliveredNeverBeginsAndTheStopComesFirst) {
  RelayedRobot relayed;
  std::atomic<int> interrupts = 0;
  relayed.robot.set_interrupt(interrupts);
  ASSERT_TRUE(comes_true([&] { return relayed.primary.num_connections() == 1; }));
  ASSERT_TRUE(relayed.primary.pull());
  std::jthread other([&] {
    EXPECT_TRUE(comes_true([&] { return waiting_for(relayed.primary.port()) > 0; }));
    ++interrupts;
  });
  const MotionResult result = relayed.robot.move_joints(distant_rad(), 1.0);
  other.join();
  EXPECT_EQ(name_of(result.outcome), "program_stopped") << result.text;
  EXPECT_EQ(result.text, "interrupted");
  ASSERT_EQ(relayed.primary.num_connections(), 2U) << "the stop went out on a new one";
  EXPECT_THAT(relayed.primary.received(1), HasSubstr("stopj"));
  EXPECT_THAT(relayed.primary.received(1), Not(HasSubstr("movej")));
  relayed.primary.plug();
  EXPECT_TRUE(comes_true([&] { return relayed.primary.is_reset(); }))
      << "the motion is thrown away with its connection";
  EXPECT_EQ(relayed.primary.received(0), "");
  EXPECT_FALSE(relayed.has_moved());
}

// The control: what a client has sent that did not throw it away comes when the cable is in again.
TEST(Relay, DeliversWhatWasSentWhileTheCableWasOut) {
  const LoopbackListener server;
  Relay relay(server.port(), Relay::Way::kThereAlone);
  TcpLink link("127.0.0.1", relay.port(), 2.0);
  ASSERT_TRUE(comes_true([&] { return relay.num_connections() == 1; }));
  ASSERT_TRUE(relay.pull());
  link.write("movej", 1.0);
  EXPECT_TRUE(comes_true([&] { return waiting_for(relay.port()) > 0; }));
  EXPECT_EQ(relay.received(0), "");
  relay.plug();
  EXPECT_TRUE(comes_true([&] { return relay.received(0) == "movej"; }));
  EXPECT_FALSE(relay.is_reset());
}

}  // namespace
}  // namespace glint
