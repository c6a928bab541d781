// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is told of a robot that is not ready, by a twin in this process.
#include "studies/cell/cell_robot.h"

#include <sys/socket.h>
#include <unistd.h>

#include <future>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hardware/twin/robot/twin_server.h"
#include "studies/cell/twin_process.h"
#include "tests/studies/cell/ur3_cells.h"
#include "tests/support/loopback_listener.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::HasSubstr;
using Json = nlohmann::ordered_json;

Cell cell_with(const std::string& model) {
  const TemporaryFolder folder;
  std::string text = test::kUr3Cell;
  text.replace(text.find("ur3"), 3, model);
  write_file(folder / "cell.toml", text);
  return read_cell(folder / "cell.toml");
}

TwinServerSettings hurried(TwinServerSettings settings) {
  settings.speedup = 50.0;
  return settings;
}

/// A cell whose robot is a twin.
struct RobotOfCell {
  explicit RobotOfCell(const std::string& model)
      : cell(cell_with(model)), server(hurried(robot_twin_settings(cell, 0))) {
    cell.robot->rtde_port = server.ports().rtde;
    cell.robot->primary_port = server.ports().primary;
    cell.robot->secondary_port = server.ports().secondary;
    cell.robot->dashboard_port = server.ports().dashboard;
  }

  Cell cell;
  TwinServer server;
};

MotionPermit typed_move() {
  return MotionPermit::from_command_line(true, "test");
}

// A motion would be refused.
TEST(RobotStatus, TellsThatAnESeriesTakesNoScripts) {
  RobotOfCell robot("ur3e");
  EXPECT_EQ(robot_status(robot.cell)["movable"], true);
  robot.server.add_fault({.kind = FaultKind::kRemoteOff});
  const Json status = robot_status(robot.cell);
  EXPECT_EQ(status["movable"], false);
  EXPECT_THAT(status["not_movable_because"].get<std::string>(), HasSubstr("remote control is off"));
}

// It greets, and is gone: nobody knows whether it is off.
TEST(RobotStatus, TellsThatTheDashboardDoesNotTellOfRemoteControl) {
  RobotOfCell robot("ur3e");
  const LoopbackListener dashboard;
  robot.cell.robot->dashboard_port = dashboard.port();
  const auto greeting = std::async(std::launch::async, [&dashboard] {
    const std::string hello = "Connected: Universal Robots Dashboard Server\n";
    const int peer = dashboard.accept(2000);
    ::send(peer, hello.data(), hello.size(), MSG_NOSIGNAL);
    ::close(peer);
  });
  const Json status = robot_status(robot.cell);
  EXPECT_EQ(status["movable"], false);
  EXPECT_THAT(status["not_movable_because"].get<std::string>(),
              HasSubstr("does not tell whether remote control is on"));
}

TEST(UnlockRobot, SendsNothingWhereThereIsNoProtectiveStop) {
  RobotOfCell robot("ur3");
  const Json normal = unlock_robot(robot.cell, typed_move());
  EXPECT_EQ(normal["ok"], false);
  EXPECT_EQ(normal["outcome"], "refused");
  EXPECT_THAT(normal["text"].get<std::string>(), HasSubstr("safety mode NORMAL"));
  robot.server.add_fault({.kind = FaultKind::kEmergencyStop});
  const Json stopped = unlock_robot(robot.cell, typed_move());
  EXPECT_EQ(stopped["ok"], false);
  EXPECT_THAT(stopped["text"].get<std::string>(), HasSubstr("safety mode ROBOT_EMERGENCY_STOP"));
  EXPECT_TRUE(stopped["replies"].empty());
  EXPECT_EQ(robot.server.num_command_bytes(), 0U);
}

// 5 s of the controller's clock are 0.1 s here.
TEST(UnlockRobot, IsDoneWhenTheStopIsGone) {
  RobotOfCell robot("ur3");
  robot.server.add_fault({.kind = FaultKind::kProtectiveStop});
  Json unlocked = unlock_robot(robot.cell, typed_move());
  for (int i = 0; i < 200 && unlocked["outcome"] == "refused"; ++i) {
    EXPECT_THAT(unlocked["text"].get<std::string>(), HasSubstr("until 5s"));
    unlocked = unlock_robot(robot.cell, typed_move());
  }
  EXPECT_EQ(unlocked["ok"], true) << unlocked;
  EXPECT_EQ(robot_status(robot.cell)["robot"]["safety_mode"], "NORMAL");
}

TEST(MoveRobot, IsRefusedWithoutPower) {
  RobotOfCell robot("ur3");
  EXPECT_EQ(power_robot(robot.cell, false, typed_move())["outcome"], "done");
  EXPECT_EQ(robot_status(robot.cell)["movable"], false);
  const Json moved =
      move_robot(robot.cell, safe_position_of(robot.cell, ""), CellMotion{}, typed_move());
  EXPECT_EQ(moved["ok"], false);
  EXPECT_EQ(moved["outcome"], "refused");
  EXPECT_THAT(moved["text"].get<std::string>(), HasSubstr("robot mode POWER_OFF"));
}

}  // namespace
}  // namespace glint
