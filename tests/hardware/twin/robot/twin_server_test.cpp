// SPDX-License-Identifier: GPL-3.0-or-later
//
// The twin and the product on the wire of the loopback network.
#include "hardware/twin/robot/twin_server.h"

#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/wall_clock.h"
#include "hardware/robot/dashboard.h"
#include "hardware/robot/digital_outputs.h"
#include "hardware/robot/twin_proof.h"
#include "hardware/robot/ur_robot.h"
#include "tests/hardware/twin/robot/robot_of_twin.h"
#include "tests/support/process_sockets.h"

namespace glint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

MotionPermit typed() {
  return MotionPermit::from_command_line(true, "test");
}

static_assert(!std::is_default_constructible_v<MotionPermit>, "a command line alone makes one");

JointVector near_goal_rad() {
  return test_start_rad() + JointVector{0.3, 0.05, -0.1, 0.0, 0.1, 0.2};
}

void expect_moves_and_reads(ArmModel model) {
  TwinServer server(on_free_ports(model));
  const UrSettings settings = settings_for(server, model);
  UrRobot robot(settings, arm_with_tool(settings, test_limits()));
  EXPECT_EQ(robot.rate_hz(), model == ArmModel::kUr3 ? 125.0 : 500.0);
  EXPECT_EQ(robot.move_joints(near_goal_rad(), 1.0).outcome, MotionOutcome::kRefused);
  EXPECT_EQ(server.num_command_bytes(), 0U) << "nothing is sent without a permit";
  robot.allow_motion(MotionPermit::from_command_line(true, "test"));
  const MotionResult result = robot.move_joints(near_goal_rad(), 1.0);
  ASSERT_TRUE(result.is_done()) << result.text;
  const auto pose = robot.still_pose(5.0);
  ASSERT_TRUE(pose.has_value());
  EXPECT_LT((pose->joints_rad - near_goal_rad()).norm(), 1e-6);
  EXPECT_LT(robot.state()->age_s, 0.3);
  EXPECT_TRUE(robot.stop().is_done());
  EXPECT_THAT(server.inputs_written(), IsEmpty());
}

TEST(UrRobot, MovesATwinAndReadsWhereItStands) {
  const std::jthread cb3(expect_moves_and_reads, ArmModel::kUr3);
  const std::jthread e_series(expect_moves_and_reads, ArmModel::kUr3e);
}

// The register of the motion's program changes every 20 ms of the twin's clock; packages lie 80 to
// 400 ms of it apart here, and may find it the same each time.
TEST(UrRobot, LongMotionsArriveHoweverFastATwinsClockIs) {
  for (const double speedup : {10.0, 20.0, 40.0, 50.0}) {
    TwinServerSettings twin = on_free_ports(ArmModel::kUr3);
    twin.speedup = speedup;
    const TwinServer server(twin);
    const UrSettings settings = settings_for(server, ArmModel::kUr3);
    UrRobot robot(settings, arm_with_tool(settings, test_limits()));
    robot.allow_motion(MotionPermit::from_command_line(true, "test"));
    JointVector goal_rad = near_goal_rad();
    goal_rad[0] += 1.5;
    const MotionResult result = robot.move_joints(goal_rad, 0.3);
    EXPECT_TRUE(result.is_done()) << speedup << ": " << result.text;
  }
}

// The slider of the pendant stays with the person in front of it.
TEST(UrRobot, WritesNoInputsButThoseOfLights) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  set_digital_outputs("127.0.0.1", server.ports().rtde, 0b0001, 0b0001, typed());
  EXPECT_THAT(server.inputs_written(),
              ElementsAre("standard_digital_output", "standard_digital_output_mask"));
  TwinController twin(test_twin(ArmModel::kUr3));
  twin.set_inputs({"speed_slider_mask", "speed_slider_fraction"}, {std::uint32_t{1}, 0.5});
  EXPECT_THAT(twin.inputs_written(), ElementsAre("speed_slider_fraction", "speed_slider_mask"))
      << "whoever wrote it would be seen";
}

TEST(UrRobot, ReadingSendsNothingToScriptsAndDashboard) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  const UrSettings settings = settings_for(server, ArmModel::kUr3);
  const UrRobot robot(settings, arm_with_tool(settings, test_limits()));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_GT(robot.num_packages(), 3U);
  EXPECT_EQ(server.num_command_bytes(), 0U);
}

// The program may end as soon as it knows the result.
TEST(UrRobot, AMotionThatHasToBeStoppedStandsStillWhenTheRobotIsLetGo) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  JointVector goal_rad = near_goal_rad();
  goal_rad[0] += 1.5;
  {
    const UrSettings settings = settings_for(server, ArmModel::kUr3);
    UrRobot robot(settings, arm_with_tool(settings, test_limits()));
    robot.allow_motion(MotionPermit::from_command_line(true, "test"));
    server.add_fault({.kind = FaultKind::kOverspeed, .when = Fault::When::kMoving, .delay_s = 0.5});
    EXPECT_EQ(robot.move_joints(goal_rad, 1.0).outcome, MotionOutcome::kLimit);
  }
  const JointVector at_rad = server.view().joints_rad;
  std::this_thread::sleep_for(std::chrono::seconds(1));
  EXPECT_TRUE(server.view().is_still);
  EXPECT_EQ(server.view().joints_rad, at_rad);
  EXPECT_GT((at_rad - goal_rad).norm(), 0.1);
}

/// How far the arm goes in a second after the safeguard stop of its motion is reset on the side
/// channel, and nobody is connected any more.
double motion_after_reset(const TwinServer& server) {
  EXPECT_EQ(ask_side_channel(server.side_channel(), "fault release"), "ok");
  const JointVector at_rad = server.view().joints_rad;
  std::this_thread::sleep_for(std::chrono::seconds(1));
  return (server.view().joints_rad - at_rad).norm();
}

void wait_for_safeguard(const TwinServer& server) {
  for (int i = 0; i < 500; ++i) {
    const auto state = ask_side_channel(server.side_channel(), "state");
    if (state && state->ends_with("SAFEGUARD_STOP") && server.view().is_still) {
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  FAIL() << "no safeguard stop";
}

TEST(SafeguardStop, InMotionMovesNothingWhenItIsResetAfterTheProductHasEnded) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  JointVector goal_rad = near_goal_rad();
  goal_rad[0] += 1.5;
  {
    const UrSettings settings = settings_for(server, ArmModel::kUr3);
    UrRobot robot(settings, arm_with_tool(settings, test_limits()));
    robot.allow_motion(MotionPermit::from_command_line(true, "test"));
    ASSERT_EQ(ask_side_channel(server.side_channel(), "fault safeguard_stop moving 0.3"), "ok");
    const MotionResult result = robot.move_joints(goal_rad, 1.0);
    EXPECT_EQ(result.outcome, MotionOutcome::kSafeguardStop);
    EXPECT_EQ(result.text, "safety mode SAFEGUARD_STOP");
  }
  wait_for_safeguard(server);
  EXPECT_EQ(motion_after_reset(server), 0.0);
}

// The same motion by a client that leaves the controller its program.
TEST(SafeguardStop, InMotionGoesOnForAClientThatDropsNoProgram) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  {
    ASSERT_EQ(ask_side_channel(server.side_channel(), "fault safeguard_stop moving 0.3"), "ok");
    TcpLink link("127.0.0.1", server.ports().primary, 2.0);
    link.write("movej([1.5, -1.7, 1.7, -1.5, -1.5, 0], a=1, v=0.5)\n", 2.0);
    wait_for_safeguard(server);
  }
  EXPECT_GT(motion_after_reset(server), 0.05);
}

TEST(UrRobot, SaysWhenTheProgramOfASafeguardStopCannotBeDropped) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  UrSettings settings = settings_for(server, ArmModel::kUr3);
  settings.dashboard_port = 1;  // nobody listens there
  UrRobot robot(settings, arm_with_tool(settings, test_limits()));
  robot.allow_motion(MotionPermit::from_command_line(true, "test"));
  server.add_fault(
      {.kind = FaultKind::kSafeguardStop, .when = Fault::When::kMoving, .delay_s = 0.2});
  const MotionResult result = robot.move_joints(near_goal_rad(), 1.0);
  EXPECT_EQ(result.outcome, MotionOutcome::kSafeguardStop);
  EXPECT_THAT(result.text, HasSubstr("end it at the pendant (127.0.0.1:1: "));
}

TEST(UrRobot, StopsWithinATimeAfterAStopAndACut) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  const UrSettings settings = settings_for(server, ArmModel::kUr3);
  UrRobot robot(settings, arm_with_tool(settings, test_limits()));
  robot.allow_motion(MotionPermit::from_command_line(true, "test"));
  server.add_fault({.kind = FaultKind::kProtectiveStop});
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  server.add_fault({.kind = FaultKind::kCut});
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_EQ(robot.stop().outcome, MotionOutcome::kLost);
}

/// Somebody else's fault, a moment after the arm has begun to move. @return when
std::chrono::steady_clock::time_point fault_in_motion(TwinServer& server, FaultKind fault) {
  for (int i = 0; i < 1000 && server.view().is_still; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const auto now = std::chrono::steady_clock::now();
  server.add_fault({.kind = fault});
  return now;
}

/// A fault on the way to a goal, what the product makes of it, and how soon. A goal that is not to
/// be reached is seconds away.
void expect_outcome(FaultKind fault, MotionOutcome outcome) {
  JointVector goal_rad = near_goal_rad();
  goal_rad[0] += outcome == MotionOutcome::kDone ? 0.0 : 1.5;
  TwinServer server(on_free_ports(ArmModel::kUr3));
  const UrSettings settings = settings_for(server, ArmModel::kUr3);
  UrRobot robot(settings, arm_with_tool(settings, test_limits()));
  robot.allow_motion(MotionPermit::from_command_line(true, "test"));
  std::chrono::steady_clock::time_point faulted;
  std::jthread other([&] { faulted = fault_in_motion(server, fault); });
  const MotionResult result = robot.move_joints(goal_rad, 1.0);
  const auto told = std::chrono::steady_clock::now();
  other.join();
  EXPECT_EQ(name_of(result.outcome), name_of(outcome)) << result.text;
  EXPECT_TRUE(outcome == MotionOutcome::kDone || told - faulted < std::chrono::milliseconds(1000))
      << name_of(outcome) << ": half a second, and half a second of a busy machine";
  if (outcome == MotionOutcome::kLost) {
    // A stop went out on the connection that was left, or on a new one.
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    const JointVector at_rad = server.view().joints_rad;
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_EQ(server.view().joints_rad, at_rad);
    EXPECT_GT((at_rad - goal_rad).norm(), 0.01) << "it was stopped on its way";
  }
}

// All at once: each waits for the clock of its own twin most of the time.
TEST(UrRobot, FaultsOnTheWireBecomeTheRightResults) {
  const std::pair<FaultKind, MotionOutcome> cases[] = {
      {FaultKind::kProtectiveStop, MotionOutcome::kProtectiveStop},
      {FaultKind::kEmergencyStop, MotionOutcome::kEmergencyStop},
      {FaultKind::kSafeguardStop, MotionOutcome::kSafeguardStop},
      {FaultKind::kOtherProgram, MotionOutcome::kProgramStopped},
      {FaultKind::kSilence, MotionOutcome::kLost},
      {FaultKind::kCut, MotionOutcome::kLost},
      {FaultKind::kRestart, MotionOutcome::kLost},
      {FaultKind::kSplit, MotionOutcome::kDone}};
  std::vector<std::jthread> threads;
  for (const auto& [fault, outcome] : cases) {
    threads.emplace_back(expect_outcome, fault, outcome);
  }
}

TEST(TwinServer, ServesTwoClientsAtOnceAndTheDashboard) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  const UrSettings settings = settings_for(server, ArmModel::kUr3);
  const UrRobot first(settings, arm_with_tool(settings, test_limits()));
  const UrRobot second(settings, arm_with_tool(settings, test_limits()));
  EXPECT_TRUE(first.state().has_value());
  EXPECT_TRUE(second.state().has_value());
  Dashboard dashboard(settings.host, settings.dashboard_port, 2.0);
  EXPECT_EQ(dashboard.ask("robotmode"), "Robotmode: RUNNING");
  EXPECT_EQ(dashboard.ask("get serial number"), "20190000000");
}

TEST(SetDigitalOutputs, SwitchesThoseOfTheMaskAndWaitsForThem) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  set_digital_outputs("127.0.0.1", server.ports().rtde, 0b0110, 0b1111, typed());
  EXPECT_EQ(server.view().digital_outputs, 0b0110U);
  set_digital_outputs("127.0.0.1", server.ports().rtde, 0b0010, 0b0000, typed());
  EXPECT_EQ(server.view().digital_outputs, 0b0100U);
  EXPECT_EQ(server.num_command_bytes(), 0U);
}

TEST(TwinProof, ATwinProvesItselfAndNothingElseDoes) {
  int port = 0;
  {
    TwinServer server(on_free_ports(ArmModel::kUr3));
    port = server.ports().rtde;
    EXPECT_TRUE(is_proven_twin("127.0.0.1", port));
    struct stat status = {};
    ASSERT_EQ(::lstat(server.side_channel().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600U);
    ASSERT_EQ(::lstat(server.side_channel().parent_path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0700U);
    ::chmod(server.side_channel().c_str(), 0666);
    EXPECT_FALSE(is_proven_twin("127.0.0.1", port)) << "a channel open to others proves nothing";
    ::chmod(server.side_channel().c_str(), 0600);
    // Its RTDE under the name of another twin: tokens differ.
    TwinServer other(on_free_ports(ArmModel::kUr3));
    std::filesystem::rename(server.side_channel(), server.side_channel().string() + ".moved");
    std::filesystem::create_hard_link(other.side_channel(), server.side_channel());
    EXPECT_FALSE(is_proven_twin("127.0.0.1", port));
    std::filesystem::remove(server.side_channel().string() + ".moved");
  }
  EXPECT_FALSE(is_proven_twin("127.0.0.1", port)) << "gone";
}

TEST(TwinServer, IsBoundToTheLoopbackNetworkAlone) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  const UrSettings settings = settings_for(server, ArmModel::kUr3);
  const UrRobot robot(settings, arm_with_tool(settings, test_limits()));
  const std::vector<ProcessSocket> sockets = sockets_of(::getpid());
  EXPECT_GE(sockets.size(), 6U) << "four listening, two ends of a connection";
  for (const ProcessSocket& socket : sockets) {
    EXPECT_EQ(socket.table, "tcp") << socket.text();
    EXPECT_TRUE(socket.is_on_loopback()) << socket.text();
  }
  TwinServerSettings open = on_free_ports(ArmModel::kUr3);
  for (const char* address : {"0.0.0.0", "192.168.1.10", "128.0.0.1", "::1", "localhost", ""}) {
    open.address = address;
    EXPECT_THROW(TwinServer{open}, ConfigError) << address;
  }
}

TEST(TwinServer, GoesOnWhenAPortIsTakenWhileItRestarts) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  server.add_fault({.kind = FaultKind::kRestart});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  {
    TwinServerSettings other = on_free_ports(ArmModel::kUr3);
    other.ports.primary = server.ports().primary;
    const TwinServer taker(other);
    std::this_thread::sleep_for(std::chrono::milliseconds(1200));
    EXPECT_FALSE(is_proven_twin("127.0.0.1", server.ports().rtde)) << "not open yet";
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_TRUE(is_proven_twin("127.0.0.1", server.ports().rtde));
}

TEST(TwinServer, APortThatIsTakenIsNamed) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  TwinServerSettings same = on_free_ports(ArmModel::kUr3);
  same.ports.rtde = server.ports().rtde;
  EXPECT_THROW(TwinServer{same}, IoError);
  EXPECT_TRUE(is_proven_twin("127.0.0.1", server.ports().rtde)) << "the first one goes on";
}

/// Written from the protocol's table alone, in another language.
void expect_second_client_agrees(ArmModel model) {
  const TwinServer server(on_free_ports(model));
  const std::string command =
      fmt::format("python3 {}/tests/hardware/twin/robot/rtde_client.py {} {} > /dev/null",
                  GLINT_SOURCE_DIR,
                  server.ports().rtde,
                  is_cb3(model) ? 125 : 500);
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(TwinServer, ASecondClientReadsItAsTheProtocolSays) {
  const std::jthread cb3(expect_second_client_agrees, ArmModel::kUr3);
  const std::jthread e_series(expect_second_client_agrees, ArmModel::kUr3e);
}

TEST(SideChannel, TakesFaultsAndTellsTheState) {
  TwinServer server(on_free_ports(ArmModel::kUr3));
  const auto ask = [&server](const std::string& line) {
    return ask_side_channel(server.side_channel(), line).value_or("nothing");
  };
  EXPECT_EQ(ask("token"), fmt::format("{}", server.token()));
  EXPECT_EQ(ask("fault emergency_stop"), "ok");
  EXPECT_THAT(ask("fault fire"), HasSubstr("error"));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_THAT(ask("state"), HasSubstr("ROBOT_EMERGENCY_STOP"));
  EXPECT_FALSE(server.is_stop_asked());
  EXPECT_EQ(ask("stop"), "ok");
  EXPECT_TRUE(server.is_stop_asked());
}

}  // namespace
}  // namespace glint
