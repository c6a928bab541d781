// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/ready_file.h"

#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "hardware/twin/robot/twin_server.h"
#include "hardware/twin/side_channel/side_channel.h"
#include "hardware/twin/stage/stage_twin.h"
#include "studies/cell/twin_process.h"
#include "tests/studies/cell/ur3_cells.h"
#include "tests/support/loopback_listener.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::HasSubstr;
using Json = nlohmann::ordered_json;

const std::string kReadyTwins = R"({"pid": 7, "twins": [
{"kind": "robot", "address": "127.0.0.1", "rtde_port": 40004, "primary_port": 40001,
 "secondary_port": 40002, "dashboard_port": 40003, "token": 18446744073709551615},
{"kind": "camera", "address": "127.0.0.5", "token": 6},
{"kind": "stage", "address": "127.0.0.1", "port": 40005, "token": 8}]})";

/// A robot, a camera and a stage elsewhere, taken to the twins of a ready file.
Cell cell_with_twins(const std::string& ready, DrivenDevices driven = DrivenDevices::kAll) {
  const TemporaryFolder folder;
  write_file(folder / "twins.json", ready);
  Cell cell;
  cell.robot.emplace().host = "192.168.0.10";
  cell.camera.emplace().address = "192.168.0.11";
  cell.stage.emplace();
  return with_ports(cell, folder / "twins.json", driven);
}

/// What is wrong with the ready file where one text is another.
std::string ready_problem(const std::string& from, const std::string& to) {
  std::string ready = kReadyTwins;
  ready.replace(ready.find(from), from.size(), to);
  return text_thrown_by<ConfigError>([&ready] { cell_with_twins(ready); });
}

TEST(ReadyFile, TakesACellToItsTwins) {
  const Cell cell = cell_with_twins(kReadyTwins);
  EXPECT_EQ(cell.robot->host, "127.0.0.1");
  EXPECT_EQ(cell.robot->rtde_port, 40004);
  EXPECT_EQ(cell.robot->primary_port, 40001);
  EXPECT_EQ(cell.robot->secondary_port, 40002);
  EXPECT_EQ(cell.robot->dashboard_port, 40003);
  EXPECT_EQ(cell.twin_tokens.robot, 18446744073709551615U);
  EXPECT_EQ(cell.camera->address, "127.0.0.5");
  EXPECT_EQ(cell.twin_tokens.camera, 6U);
  EXPECT_EQ(cell.stage->host, "127.0.0.1");
  EXPECT_EQ(cell.stage->port, 40005);
  EXPECT_EQ(cell.twin_tokens.stage, 8U);
}

/// Twins of these kinds alone.
std::string ready_with(const std::vector<std::string>& kinds) {
  const std::map<std::string, std::string> twins = {
      {"robot",
       R"({"kind": "robot", "address": "127.0.0.1", "rtde_port": 40004, "primary_port": 40001,
           "secondary_port": 40002, "dashboard_port": 40003, "token": 5})"},
      {"camera", R"({"kind": "camera", "address": "127.0.0.5", "token": 6})"},
      {"stage", R"({"kind": "stage", "address": "127.0.0.1", "port": 40005, "token": 8})"}};
  std::string list;
  for (const std::string& kind : kinds) {
    list += (list.empty() ? "" : ", ") + twins.at(kind);
  }
  return R"({"pid": 7, "twins": [)" + list + "]}";
}

// The cell's own would be driven in its place.
TEST(ReadyFile, WithoutATwinOfWhatIsDrivenIsRefused) {
  struct Case {
    std::vector<std::string> there;
    DrivenDevices driven;
    const char* missing;  ///< empty: nothing
  };

  const Case cases[] = {{{"camera", "stage"}, DrivenDevices::kRobot, "robot"},
                        {{"robot"}, DrivenDevices::kRobot, ""},
                        {{"robot", "stage"}, DrivenDevices::kCamera, "camera"},
                        {{"camera"}, DrivenDevices::kCamera, ""},
                        {{"camera", "stage"}, DrivenDevices::kAll, "robot"},
                        {{"robot", "stage"}, DrivenDevices::kAll, "camera"},
                        {{"robot", "camera"}, DrivenDevices::kAll, "stage"},
                        {{"robot", "camera", "stage"}, DrivenDevices::kAll, ""}};
  for (const Case& one : cases) {
    const std::string ready = ready_with(one.there);
    const std::string missing = one.missing;
    const std::string problem =
        text_thrown_by<ConfigError>([&] { cell_with_twins(ready, one.driven); });
    EXPECT_THAT(problem,
                HasSubstr(missing.empty() ? "nothing thrown"
                                          : "twins.json: has no twin of the cell's " + missing))
        << ready;
  }
}

TEST(ReadyFile, LeavesOutWhatHasNoTwinAndIsNotDriven) {
  const Cell grabbed = cell_with_twins(ready_with({"camera"}), DrivenDevices::kCamera);
  EXPECT_FALSE(grabbed.robot.has_value());
  EXPECT_FALSE(grabbed.stage.has_value());
  EXPECT_EQ(grabbed.camera->address, "127.0.0.5");
  const Cell moved = cell_with_twins(ready_with({"robot"}), DrivenDevices::kRobot);
  EXPECT_FALSE(moved.camera.has_value());
  EXPECT_EQ(moved.robot->host, "127.0.0.1");
}

// A program shows pictures: it moves nothing, and has no twin.
TEST(ReadyFile, LeavesAStageThatShowsPicturesAsItIs) {
  const TemporaryFolder folder;
  write_file(folder / "twins.json", ready_with({"robot", "camera"}));
  Cell cell;
  cell.stage.emplace().kind = CellStage::Kind::kFolder;
  EXPECT_TRUE(with_ports(cell, folder / "twins.json", DrivenDevices::kAll).stage.has_value());
}

// Nobody listens there, and if somebody did, nothing would prove that it is a twin.
TEST(ReadyFile, OfTwinsThatHaveEndedLeadsToNothingThatIsDriven) {
  const LoopbackListener taken;
  Cell cell = cell_with_twins(ready_with({"robot"}), DrivenDevices::kRobot);
  cell.robot->rtde_port = taken.port();
  EXPECT_THAT(text_thrown_by<IoError>([&] { is_robot_twin(cell); }),
              HasSubstr(fmt::format("127.0.0.1:{} does not prove", taken.port())));
  cell.twins.clear();
  EXPECT_FALSE(is_robot_twin(cell)) << "without --twin it is a robot like any other";
}

// As one that has taken the port of the file's twin, which has ended.
TEST(ReadyFile, LeadsToNoOtherTwinThanItsOwn) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", test::kUr3Cell);
  const Cell cell = read_cell(folder / "cell.toml");
  const TwinServer server(robot_twin_settings(cell, 0));
  Json twin = robot_twin_description(server);
  const auto is_twin = [&] {
    const Json ready = {{"pid", 7}, {"twins", Json::array({twin})}};
    write_file(folder / "twins.json", ready.dump());
    return is_robot_twin(with_ports(cell, folder / "twins.json", DrivenDevices::kRobot));
  };
  EXPECT_TRUE(is_twin());
  twin["token"] = server.token() - 1;
  EXPECT_THAT(text_thrown_by<IoError>([&] { is_twin(); }),
              HasSubstr("is another twin than the file's"));
  twin.erase("token");
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { is_twin(); }),
              HasSubstr("token of the twin \"robot\": must be the number"));
}

/// What comes of a stage's twin that tells one token, beside a side channel that tells another.
std::string stage_problem(const std::string& kept, const std::string& told, std::uint64_t token) {
  const StageTwin twin({.kept_text = kept});
  const SideChannel side(stage_twin_socket(twin.port()), [&](const std::string&) { return told; });
  Cell cell;
  cell.twins = "twins.json";
  cell.stage = {.host = "127.0.0.1", .port = twin.port()};
  cell.twin_tokens.stage = token;
  return text_thrown_by<IoError>([&cell] { check_stage_twin(cell); });
}

TEST(ReadyFile, LeadsToNoOtherStageThanItsOwn) {
  EXPECT_EQ(stage_problem("12", "12", 12), "nothing thrown");
  EXPECT_THAT(stage_problem("12", "12", 13), HasSubstr("is another twin than the file's"));
  EXPECT_THAT(stage_problem("", "12", 12), HasSubstr("does not prove that it is a twin"));
  EXPECT_THAT(stage_problem("12", "13", 12), HasSubstr("does not prove that it is a twin"));
}

// No twin is there: the file would lead to a robot, by names or numbers.
TEST(ReadyFile, ThatLeadsElsewhereIsRefused) {
  for (const char* elsewhere : {"192.168.0.10", "0.0.0.0", "128.0.0.1", "robot.example", ""}) {
    const std::string problem = ready_problem("127.0.0.1", elsewhere);
    EXPECT_THAT(problem, HasSubstr("address of the twin \"robot\"")) << elsewhere;
    EXPECT_THAT(problem, HasSubstr("127.0.0.0/8"));
  }
  EXPECT_THAT(ready_problem("127.0.0.5", "10.0.0.5"), HasSubstr("of the twin \"camera\""));
}

TEST(ReadyFile, WhatOnlyAsksIsNotSentToPortsThatTakeScripts) {
  EXPECT_THAT(ready_problem("40004", "30002"), HasSubstr("rtde_port of the twin \"robot\": is"));
  EXPECT_THAT(ready_problem("40003", "40001"), HasSubstr("dashboard_port of the twin"));
}

TEST(ReadyFile, SlipsAreNamed) {
  for (const char* slip : {"0", "65536", "-4", "4.5", "\"40004\"", "null"}) {
    EXPECT_THAT(ready_problem("40004", slip), HasSubstr("rtde_port")) << slip;
  }
  for (const char* slip : {"-1", "1.5", "\"1\"", "null"}) {
    EXPECT_THAT(ready_problem("18446744073709551615", slip),
                HasSubstr("token of the twin \"robot\": must be the number"))
        << slip;
  }
  EXPECT_THAT(ready_problem("\"127.0.0.5\"", "5"), HasSubstr("address of the twin \"camera\""));
  EXPECT_THAT(ready_problem("\"token\": 6", "\"token\": \"6\""),
              HasSubstr("token of the twin \"camera\": must be the number"));
  EXPECT_THAT(ready_problem(", \"token\": 8", ""), HasSubstr("token of the twin \"stage\""));
  EXPECT_THAT(
      ready_problem("{\"kind\": \"camera\", \"address\": \"127.0.0.5\", \"token\": 6}", "5"),
      HasSubstr("is no ready file"));
  EXPECT_THAT(ready_problem("7", "\"7\""), HasSubstr("is no ready file"));
}

}  // namespace
}  // namespace glint
