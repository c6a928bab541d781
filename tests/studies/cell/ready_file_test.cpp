// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/ready_file.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::HasSubstr;

const std::string kReadyTwins = R"({"pid": 7, "twins": [
{"kind": "robot", "address": "127.0.0.1", "rtde_port": 40004, "primary_port": 40001,
 "secondary_port": 40002, "dashboard_port": 40003},
{"kind": "camera", "address": "127.0.0.5"},
{"kind": "stage", "address": "127.0.0.1", "port": 40005}]})";

/// A robot, a camera and a stage elsewhere, taken to the twins of a ready file.
Cell cell_with_twins(const std::string& ready) {
  const TemporaryFolder folder;
  write_file(folder / "twins.json", ready);
  Cell cell;
  cell.robot.emplace().host = "192.168.0.10";
  cell.camera.emplace().address = "192.168.0.11";
  cell.stage.emplace();
  return with_ports(cell, folder / "twins.json");
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
  EXPECT_EQ(cell.camera->address, "127.0.0.5");
  EXPECT_EQ(cell.stage->host, "127.0.0.1");
  EXPECT_EQ(cell.stage->port, 40005);
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
  EXPECT_THAT(ready_problem("\"127.0.0.5\"", "5"), HasSubstr("address of the twin \"camera\""));
  EXPECT_THAT(ready_problem("{\"kind\": \"camera\", \"address\": \"127.0.0.5\"}", "5"),
              HasSubstr("is no ready file"));
  EXPECT_THAT(ready_problem("7", "\"7\""), HasSubstr("is no ready file"));
}

}  // namespace
}  // namespace glint
