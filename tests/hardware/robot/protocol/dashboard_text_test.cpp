// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/protocol/dashboard_text.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

TEST(DashboardReply, ValueStandsAfterTheColon) {
  EXPECT_EQ(value_of_reply("Robotmode: RUNNING"), "RUNNING");
  EXPECT_EQ(value_of_reply("UR3"), "UR3");
  EXPECT_EQ(flag_of_reply("Program running: false"), false);
  EXPECT_EQ(flag_of_reply("true"), true);
  EXPECT_EQ(flag_of_reply("could not understand: \"x\""), std::nullopt);
}

TEST(DashboardReply, FailuresAreTold) {
  EXPECT_TRUE(is_success("Protective stop releasing"));
  EXPECT_TRUE(is_success("Powering on"));
  EXPECT_FALSE(is_success("Cannot unlock protective stop until 5s after occurrence."));
  EXPECT_FALSE(is_success("Failed to execute: play"));
  EXPECT_FALSE(is_success("could not understand: \"jump\""));
}

TEST(RemoteControlProblem, TellsOffFromNotTold) {
  EXPECT_EQ(remote_control_problem("true"), "");
  EXPECT_EQ(remote_control_problem("false"),
            "remote control is off: switch it on at the pendant (\"false\")");
  EXPECT_EQ(remote_control_problem("maybe"),
            "the dashboard does not tell whether remote control is on (\"maybe\")");
}

TEST(IsQuery, IsFalseForAllThatChangesTheController) {
  EXPECT_TRUE(is_query("robotmode"));
  EXPECT_TRUE(is_query("is in remote control"));
  for (const char* command : {"power on",
                              "power off",
                              "brake release",
                              "unlock protective stop",
                              "close safety popup",
                              "restart safety",
                              "play",
                              "pause",
                              "stop",
                              "load x.urp",
                              "shutdown",
                              "quit",
                              "popup x",
                              "addToLog x",
                              ""}) {
    EXPECT_FALSE(is_query(command)) << command;
  }
}

}  // namespace
}  // namespace glint
