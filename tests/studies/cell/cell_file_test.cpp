// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/cell_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "hardware/robot/path_check.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kRobot = R"([robot]
model = "ur3e"
host = "127.0.0.1"
flange_from_tcp = [0, 0, 80, 0, 0, 0]
tool_radius_mm = 35
payload_kg = 0.6
)";

const std::string kLimits = R"([limits]
tool_speed_mm_s = 250
tool_acceleration_mm_s2 = 500
joint_speed_deg_s = 90
joint_acceleration_deg_s2 = 180
box_min_mm = [-600, -600, 20]
box_max_mm = [600, 600, 900]
)";

const std::string kHome =
    "[[safe_position]]\nname = \"home\"\njoints_deg = [0, -90, 90, -90, -90, 0]\n";

Cell cell_of(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", text);
  return read_cell(folder / "cell.toml");
}

std::string problem_of(const std::string& text) {
  return text_thrown_by<ConfigError>([&text] { cell_of(text); });
}

std::string without(std::string text, const std::string& line_begin) {
  const std::size_t at = text.find(line_begin);
  return text.erase(at, text.find('\n', at) + 1 - at);
}

// 90 degrees a second are pi / 2 rad/s.
TEST(ReadCell, ConvertsUnitsOnce) {
  const Cell cell =
      cell_of(kRobot + kLimits + kHome +
              "[lights.ring]\noutput = 3\n"
              "[[view]]\njoints_deg = [90, 0, 0, 0, 0, 180]\nlights = [\"ring\"]\n"
              "exposure_us = 5000\n"
              "[camera]\nexposure_us = 20000\n[camera.features]\nLineMode = \"Output\"\n"
              "BlackLevel = 16\n");
  EXPECT_DOUBLE_EQ(cell.limits.joint_speed_rad_s, kPi / 2.0);
  EXPECT_DOUBLE_EQ(cell.limits.joint_acceleration_rad_s2, kPi);
  EXPECT_DOUBLE_EQ(cell.limits.tool_speed_mm_s, 250.0);
  EXPECT_DOUBLE_EQ(view_of(cell, "1").joints_rad[0], kPi / 2.0);
  EXPECT_DOUBLE_EQ(*view_of(cell, "1").exposure_s, 0.005);
  EXPECT_DOUBLE_EQ(camera_of(cell).exposure_s, 0.02);
  EXPECT_EQ(camera_of(cell).features.size(), 2U);
  EXPECT_EQ(camera_of(cell).features[0].value, "Output");
  EXPECT_EQ(camera_of(cell).features[1].value, "16");
  EXPECT_EQ(cell.lights[0].output, 3);
  EXPECT_EQ(safe_position_of(cell, "").name, "home");
}

TEST(CellName, IsThatOfTheFolderAround) {
  EXPECT_EQ(cell_name("cells/robot_cell/cell.toml"), "robot_cell");
  EXPECT_EQ(cell_name("cell.toml"), std::filesystem::current_path().filename().string());
}

TEST(ReadCell, LimitsHaveNoDefault) {
  EXPECT_THAT(problem_of(kRobot + kHome), HasSubstr("limits: is missing"));
  for (const char* key : {"tool_speed_mm_s",
                          "tool_acceleration_mm_s2",
                          "joint_speed_deg_s",
                          "joint_acceleration_deg_s2",
                          "box_min_mm",
                          "box_max_mm"}) {
    EXPECT_THAT(problem_of(kRobot + without(kLimits, key) + kHome),
                HasSubstr(std::string("limits.") + key + ": is missing"));
  }
}

TEST(ReadCell, NamesEverySlipWithItsPlace) {
  EXPECT_THAT(problem_of(without(kRobot, "payload_kg") + kLimits + kHome),
              HasSubstr("robot.payload_kg: is missing"));
  EXPECT_THAT(problem_of(kRobot + kLimits), HasSubstr("safe_position"));
  EXPECT_THAT(problem_of(kRobot + "speed = 3\n" + kLimits + kHome), HasSubstr("cell.toml:7:"));
  EXPECT_THAT(problem_of(kRobot + kLimits + kHome + "[robots]\n"),
              HasSubstr("is no table of a cell"));
  EXPECT_THAT(problem_of(kRobot + kLimits + kHome + "[[view]]\nname = \"a\"\n"),
              HasSubstr("joints_deg: is missing"));
  EXPECT_THAT(problem_of(kRobot + kLimits + kHome +
                         "[[view]]\njoints_deg = [0, 0, 0, 0, 0, 0]\nlights = [\"bar\"]\n"),
              HasSubstr("[lights.bar]"));
  EXPECT_THAT(problem_of(kRobot + kLimits + kHome + "[lights.ring]\noutput = 9\n"),
              HasSubstr("lights.ring.output: is 9"));
  EXPECT_THAT(problem_of("[calibration]\n"), HasSubstr("[camera] or [robot]"));
  std::string swapped = kLimits;
  swapped.replace(swapped.find("[-600, -600, 20]"), 16, "[700, -600, 20]");
  EXPECT_THAT(problem_of(kRobot + swapped + kHome), HasSubstr("must be above box_min_mm"));
}

// Both would be switched together, and pictures of one have the other's light. Without a key the
// output is 0.
TEST(SharedOutputs, AreThoseOfTwoLights) {
  const auto problem = [](const std::string& lights) {
    const Cell cell = cell_of(kRobot + kLimits + kHome + lights);  // read: not all drive it
    return text_thrown_by<ConfigError>([&cell] { throw_if_any(shared_outputs(cell)); });
  };
  EXPECT_THAT(problem("[lights.ring]\noutput = 3\n[lights.dome]\noutput = 2\n"
                      "[lights.bar]\nsettle_s = 1\noutput = 3\n"),
              HasSubstr("cell.toml:23:1: lights.bar.output: is 3, as that of lights.ring"));
  EXPECT_THAT(problem("[lights.ring]\noutput = 0\n[lights.bar]\nsettle_s = 1\n"),
              AllOf(HasSubstr("cell.toml:19:"), HasSubstr("lights.bar.output: is 0, as that of")));
  EXPECT_EQ(problem("[lights.ring]\noutput = 3\n[lights.bar]\noutput = 2\n"), "nothing thrown");
  EXPECT_EQ(problem("[lights.ring]\noutput = 3\n[lights.bar]\nkind = \"manual\"\noutput = 3\n"
                    "[lights.dome]\nkind = \"manual\"\n"),
            "nothing thrown")
      << "a person switches one after the other";
}

// Questions are written to RTDE and dashboard without --move: to ports that run what they are sent
// they would be programs.
TEST(ReadCell, NoQuestionGoesToAPortThatTakesScripts) {
  const auto problem = [](const std::string& ports) {
    return problem_of(kRobot + ports + kLimits + kHome);
  };
  for (const char* script_port : {"30001", "30002", "30003", "30020"}) {
    for (const std::string key : {"rtde_port", "dashboard_port"}) {
      EXPECT_THAT(problem(key + " = " + script_port + "\n"),
                  HasSubstr("robot." + key + ": is " + script_port + ", where controllers"));
    }
  }
  EXPECT_THAT(problem("dashboard_port = 7001\nprimary_port = 7001\n"), HasSubstr("cell.toml:7:"));
  EXPECT_THAT(problem("rtde_port = 7002\nsecondary_port = 7002\n"),
              HasSubstr("robot.rtde_port: is 7002, as primary_port or secondary_port"));
  EXPECT_THAT(problem("primary_port = 30004\n"), HasSubstr("robot.rtde_port: is 30004"));
  EXPECT_THAT(problem("rtde_port = 29999\n"), HasSubstr("robot.dashboard_port: is 29999"));
  EXPECT_EQ(problem("rtde_port = 7004\nprimary_port = 7001\nsecondary_port = 7001\n"),
            "nothing thrown");
}

TEST(ViewOf, FindsByNameAndNumberAndNamesWhatThereIs) {
  const Cell cell = cell_of(kRobot + kLimits + kHome +
                            "[[view]]\nname = \"left\"\njoints_deg = [1, 0, 0, 0, 0, 0]\n"
                            "[[view]]\nname = \"right\"\njoints_deg = [2, 0, 0, 0, 0, 0]\n");
  EXPECT_EQ(view_of(cell, "right").name, "right");
  EXPECT_EQ(view_of(cell, "1").name, "left");
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { view_of(cell, "3"); }), HasSubstr("1 to 2"));
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { view_of(cell, "0"); }), HasSubstr("1 to 2"));
}

// From any position of the gallery's cell the arm may go to any other.
TEST(GalleryCell, ItsPositionsReachOneAnother) {
  const Cell cell =
      read_cell(std::filesystem::path(GLINT_SOURCE_DIR) / "studies/gallery/twin_cell/cell.toml");
  const ArmWithTool arm = arm_with_tool(robot_of(cell), cell.limits);
  std::vector<CellPosition> positions = cell.safe_positions;
  positions.insert(positions.end(), cell.views.begin(), cell.views.end());
  for (const CellPosition& from : positions) {
    for (const CellPosition& to : positions) {
      const CheckedMotion motion =
          check_joint_motion(arm,
                             Eigen::Map<const JointVector>(from.joints_rad.data()),
                             Eigen::Map<const JointVector>(to.joints_rad.data()),
                             1.0);
      EXPECT_TRUE(motion.is_allowed()) << from.name << " to " << to.name << ": " << motion.text;
    }
  }
}

}  // namespace
}  // namespace glint
