// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/pose_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <tuple>
#include <utility>

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

RobotPoses read(const std::string& text,
                const std::string& ending,
                const PoseConvention& said = {}) {
  return robot_poses(parse_pose_file(text, "robot_1" + ending, ending), said);
}

std::string file_error(const std::string& text,
                       const std::string& ending,
                       const PoseConvention& said = {}) {
  try {
    read(text, ending, said);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

/// x of the flange in every file of these tests is 400 mm, and it is turned about x by 1 rad.
void expect_pose(const RobotPoses& poses, const std::string& name) {
  ASSERT_EQ(poses.poses.size(), 1U);
  EXPECT_EQ(poses.poses[0].name, name);
  EXPECT_NEAR(poses.poses[0].base_from_flange.translation().x(), 400.0, 1e-9);
  EXPECT_NEAR(poses.poses[0].base_from_flange.linear()(2, 1), std::sin(1.0), 1e-9);
}

TEST(PoseFile, ReadsCsvWithAndWithoutNamesAndHeads) {
  expect_pose(read("a.png, 0.4, 0, 0, 1, 0, 0\n", ".csv"), "a.png");
  expect_pose(read("# x y z\n400,0,0,1,0,0\n", ".csv"), "");
  expect_pose(read("7,0.4,0,0,0.479425538604203,0,0,0.877582561890373\n", ".csv"), "7");
  expect_pose(read("time,file,x,y,z,qw,qx,qy,qz\n"
                   "12.5,a.png,0.4,0,0,0.877582561890373,0.479425538604203,0,0\n",
                   ".csv"),
              "a.png");
}

TEST(PoseFile, ReadsJsonTomlAndYaml) {
  expect_pose(read(R"([[400, 0, 0, 1, 0, 0]])", ".json"), "");
  expect_pose(read(R"({"poses": [{"picture": "a.png", "pose": [400, 0, 0, 1, 0, 0]}]})", ".json"),
              "a.png");
  expect_pose(read("[[pose]]\nname = \"a.png\"\nstamp_s = 3.5\nbase_from_flange = "
                   "[[1,0,0,400],[0,0.5403023058681398,-0.8414709848078965,0],"
                   "[0,0.8414709848078965,0.5403023058681398,0],[0,0,0,1]]\n",
                   ".toml"),
              "a.png");
  expect_pose(
      read("rows: 6\ncols: 1\ndata:\n  - [0.4]\n  - [0]\n  - [0]\n  - [1]\n  - [0]\n  - [0]\n",
           ".yaml"),
      "robot_1");
  expect_pose(read("poses:\n  - name: a.png\n    pose: [0.4, 0, 0, 1, 0, 0]\n", ".yml"), "a.png");
}

TEST(PoseFile, TakesTheFilesConventionAndTheUsersBeforeIt) {
  const std::string text =
      "[convention]\nunit = \"mm\"\nrotation = \"euler\"\nangle = \"rad\"\neuler_order = \"xyz\"\n"
      "direction = \"flange_from_base\"\n[[pose]]\npose = [400, 0, 0, 1, 0, 0]\n";
  const RobotPoses by_file = read(text, ".toml");
  EXPECT_TRUE(by_file.told.empty());
  EXPECT_EQ(by_file.convention.direction, PoseDirection::kFlangeFromBase);
  EXPECT_NEAR(by_file.poses[0].base_from_flange.translation().x(), -400.0, 1e-9);
  expect_pose(read(text, ".toml", {.direction = PoseDirection::kBaseFromFlange}), "");
}

/// What a user says, written as a file's convention is.
PoseConvention convention_of(const std::string& keys) {
  return parse_pose_file("[convention]\n" + keys + "\n[[pose]]\npose = [1, 2, 3, 0, 0, 0]\n",
                         "said.toml",
                         ".toml")
      .convention;
}

/// Also where the user says the default.
TEST(PoseFile, TheUserOverrulesEachKeyOfAFile) {
  const std::string file =
      "[convention]\nunit = \"mm\"\ndirection = \"flange_from_base\"\nrotation = \"euler\"\n"
      "angle = \"rad\"\neuler_order = \"xyz\"\nflange_from_tcp = [0, 0, 9, 0, 0, 0]\n"
      "[[pose]]\npose = [30, 40, 0, 1, 2, 3]\n[[pose]]\npose = [9, 9, 9, 4, 5, 6]\n";
  const auto by = [&](const std::string& keys) {
    return read(file, ".toml", convention_of(keys)).convention;
  };
  const PoseConvention kept = by("");
  EXPECT_EQ(kept.euler_order, "xyz");
  EXPECT_EQ(kept.flange_from_tcp.size(), 6U);
  EXPECT_EQ(by("euler_order = \"zyx\"").euler_order, "zyx");
  EXPECT_TRUE(by("flange_from_tcp = []").flange_from_tcp.empty());
  EXPECT_EQ(by("direction = \"base_from_flange\"").direction, PoseDirection::kBaseFromFlange);
  EXPECT_EQ(by("direction = \"auto\"").direction, PoseDirection::kBaseFromFlange);
  EXPECT_EQ(by("rotation = \"rotation_vector\"").rotation, PoseRotation::kRotationVector);
  EXPECT_EQ(by("rotation = \"auto\"").rotation, PoseRotation::kRotationVector);
  EXPECT_EQ(by("angle = \"deg\"").angle, PoseAngle::kDegree);
  EXPECT_THAT(file_error(file, ".toml", convention_of("unit = \"m\"")),
              HasSubstr("unit: is \"m\""));
}

/// Writes files of poses into a folder of the test and reads them together.
std::string error_of_files(const std::vector<std::pair<std::string, std::string>>& files,
                           const PoseConvention& said = {}) {
  const fs::path folder = fs::path(testing::TempDir()) / "glint_pose_files";
  fs::create_directories(folder);
  std::vector<fs::path> paths;
  for (const auto& [name, text] : files) {
    paths.push_back(folder / name);
    std::ofstream(paths.back()) << text;
  }
  std::string error = "no error";
  try {
    read_poses(paths, said);
  } catch (const ConfigError& refusal) {
    error = refusal.what();
  }
  fs::remove_all(folder);
  return error;
}

TEST(PoseFile, RefusesFilesThatContradictEachOther) {
  const auto file = [](const std::string& keys) {
    return "[convention]\n" + keys + "\n[[pose]]\npose = [0, 40, 30, 1, 2, 3]\n";
  };
  const std::vector<std::tuple<std::string, std::string, std::string>> slips = {
      {"unit", "unit = \"mm\"", "unit = \"m\""},
      {"direction", "direction = \"base_from_flange\"", "direction = \"flange_from_base\""},
      {"rotation", "rotation = \"euler\"", "rotation = \"rotation_vector\""},
      {"angle", "angle = \"rad\"", "angle = \"deg\""},
      {"euler_order", "euler_order = \"zyx\"", "euler_order = \"xyz\""},
      {"flange_from_tcp", "flange_from_tcp = []", "flange_from_tcp = [0, 0, 9, 0, 0, 0]"}};
  for (const auto& [key, one, other] : slips) {
    const std::string error = error_of_files({{"a.toml", file(one)}, {"b.toml", file(other)}});
    EXPECT_THAT(error, HasSubstr("b.toml: convention." + key + ": differs from that of "));
    EXPECT_THAT(error, HasSubstr("a.toml;"));
    EXPECT_EQ(error_of_files({{"a.toml", file(one)}, {"b.toml", file("")}}), "no error") << key;
    EXPECT_EQ(error_of_files({{"a.toml", file(one)}, {"b.toml", file(other)}}, convention_of(one)),
              "no error")
        << key;
  }
}

TEST(PoseFile, ReadsTheColumnsOfATableByTheirNames) {
  expect_pose(read("name,rx,ry,rz,z,y,x\na.png,1,0,0,0,0,400\n", ".csv"), "a.png");
  expect_pose(read("qz,qw,qy,qx,x,y,z\n0,0.877582561890373,0,0.479425538604203,400,0,0\n", ".csv"),
              "");
  expect_pose(read("roll,pitch,yaw,tx,ty,tz\n1,0,0,400,0,0\n", ".csv"), "");
  expect_pose(read("x,y,z,r11,r12,r13,r21,r22,r23,r31,r32,r33\n400,0,0,1,0,0,0,0.5403023058681398,"
                   "-0.8414709848078965,0,0.8414709848078965,0.5403023058681398\n",
                   ".csv"),
              "");
  expect_pose(read("x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n0.4,0,0,1,0,0\n", ".csv"), "");
  const RobotPoses told = read("x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\n400,0,0,1,0,0\n", ".csv");
  EXPECT_EQ(told.convention.angle, PoseAngle::kDegree);
  EXPECT_THAT(told.told, Not(Contains(HasSubstr("unit"))));
  // Names that nobody knows are read by their positions, beside those that are.
  expect_pose(read("x,y,z,u1,u2,u3\n400,0,0,1,0,0\n", ".csv"), "");
}

// Rx(1) Ry(0.5) Rz(0): whatever the order of the columns, each name settles its axis.
TEST(PoseFile, AnglesWithNamesKeepTheirAxesInAnotherOrder) {
  PoseConvention said;
  said.rotation = PoseRotation::kEuler;
  said.euler_order = "xyz";
  const Eigen::Matrix3d right = (Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()) *
                                 Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()))
                                    .toRotationMatrix();
  for (const char* text : {"x,y,z,roll,pitch,yaw\n400,0,0,1,0.5,0\n",
                           "x,y,z,yaw,pitch,roll\n400,0,0,0,0.5,1\n",
                           "x,y,z,r,p,y\n400,0,0,1,0.5,0\n"}) {
    const RobotPoses poses = read(text, ".csv", said);
    EXPECT_LT((poses.poses[0].base_from_flange.linear() - right).norm(), 1e-9) << text;
  }
}

TEST(PoseFile, SmallAnglesAreDegreesWhereTheirColumnsSaySo) {
  const RobotPoses poses = read(
      "x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\n400,0,0,1,0,0\n400,9,0,2,0,0\n400,0,9,0,3,0\n", ".csv");
  EXPECT_EQ(poses.convention.angle, PoseAngle::kDegree);
}

TEST(PoseFile, RefusesAnglesInAnotherOrderThanTheirNames) {
  EXPECT_THAT(file_error("x,y,z,rz,ry,rx\n1,2,3,0,0,0\n", ".csv"),
              HasSubstr("robot_1.csv:1:1: rotation: \"rz\", \"ry\" and \"rx\" may be"));
}

TEST(PoseFile, RefusesATableWhoseNamesContradictTheirPositions) {
  EXPECT_THAT(file_error("z,y,x,u1,u2,u3\n1,2,3,0,0,0\n", ".csv"),
              HasSubstr("robot_1.csv:1:1: pose: \"z\" is the name of number 1"));
  EXPECT_THAT(file_error("x,y,x,rx,ry,rz\n1,2,3,0,0,0\n", ".csv"),
              HasSubstr("robot_1.csv:1:5: pose: \"x\" is the name of number 3"));
  EXPECT_THAT(file_error("x_mm,y_m,z_mm,rx,ry,rz\n1,2,3,0,0,0\n", ".csv"),
              HasSubstr("unit: \"x\" and \"y\" have different units"));
}

TEST(PoseFile, TellsWhereSomethingIsWrong) {
  EXPECT_THAT(file_error("a,1,2,3,0,0,0\nb,1,2,x,0,0,0\n", ".csv"),
              HasSubstr("robot_1.csv:2:7: pose: 'x' is no number"));
  EXPECT_THAT(file_error("a,1,2,3,0,0,0\nb,1,2,3,0,0\n", ".csv"),
              HasSubstr("robot_1.csv:2:1: pose: has 6 columns, the first line has 7"));
  EXPECT_THAT(file_error("a,1,2,3,0,0,nan\n", ".csv"),
              HasSubstr("robot_1.csv:1:1: pose: number 6 is nan"));
  EXPECT_THAT(
      file_error("a,1,2,3,0,0,0\na,1,2,3,0,0,1\n", ".csv"),
      HasSubstr("robot_1.csv:2:1: name: \"a\" is the name of an earlier pose, robot_1.csv:1"));
  EXPECT_THAT(
      file_error("time,x,y,z,a,b,c\n5,1,2,3,0,0,0\n5,1,2,3,0,0,1\n", ".csv"),
      HasSubstr("robot_1.csv:3:1: stamp_s: 5 is the stamp of an earlier pose, robot_1.csv:2"));
  EXPECT_THAT(file_error("[[pose]]\nposition = [1]\n", ".toml"),
              HasSubstr("robot_1.toml:2:1: position: unknown key"));
  EXPECT_THAT(file_error("{\"posess\": []}", ".json"), HasSubstr("posess: unknown key"));
  EXPECT_THAT(file_error("[]", ".json"), HasSubstr("poses: there is none"));
  EXPECT_THAT(file_error("", ".csv"), HasSubstr("poses: there is none"));
  EXPECT_THAT(file_error("[convention]\nunit = \"inch\"\n", ".toml"),
              HasSubstr("robot_1.toml:2:1: convention.unit: is \"inch\", must be one of \"auto\""));
  EXPECT_THAT(file_error("[convention]\neuler_order = \"xxy\"\n", ".toml"),
              HasSubstr("convention.euler_order: is \"xxy\", must be three of x, y, z"));
  EXPECT_THAT(file_error("x", ".txt"), HasSubstr("must end in .csv"));
}

/// What spreadsheets of other countries and systems write.
TEST(PoseFile, TellsWhatATableIsThatHasNoCommasBetweenItsColumns) {
  const char* semicolons =
      "robot_1.csv:1:1: pose: columns are separated by semicolons, must be by commas, and numbers "
      "have a point";
  EXPECT_THAT(file_error("name;x;y;z;rx;ry;rz\na;1;2;3;0;0;0\n", ".csv"), HasSubstr(semicolons));
  EXPECT_THAT(file_error("a;1,5;2,5;3;0;0;0,1\n", ".csv"), HasSubstr(semicolons));
  EXPECT_THAT(file_error("a\t1\t2\t3\t0\t0\t0\n", ".csv"), HasSubstr("are separated by tabs"));
  EXPECT_THAT(file_error("a 1 2 3 0 0 0\n", ".csv"), HasSubstr("are separated by blanks"));
  EXPECT_THAT(file_error("a,\"1,5\",2,3,0,0,0\n", ".csv"),
              HasSubstr("robot_1.csv:1:3: pose: '1,5' is no number, its comma must be a point"));
  EXPECT_THAT(file_error("a,1,2,3,0,0,0\rb,1,2,4,0,0,0\r", ".csv"),
              HasSubstr("lines end with a carriage return alone"));
  const std::string utf16("a\0,\0001\0", 6);
  for (const char* ending : {".csv", ".yaml"}) {
    EXPECT_THAT(file_error(utf16, ending), HasSubstr("is no text in UTF-8: byte 2 is 0"));
  }
}

TEST(PoseFile, ReadsThePosesOfTheBoardOnARobot) {
  const fs::path file = fs::path(GLINT_SHARED_DIR) / "data/calibration/board_on_robot/poses.csv";
  if (!fs::exists(file)) {
    GTEST_SKIP() << "no " << file;
  }
  const RobotPoses poses = read_poses({{file}}, {});
  ASSERT_EQ(poses.poses.size(), 19U);
  EXPECT_EQ(poses.poses[3].name, "img04.png");
  EXPECT_EQ(poses.convention.unit, PoseUnit::kMillimetre);
  EXPECT_EQ(poses.convention.rotation, PoseRotation::kMatrix);
  EXPECT_NEAR(poses.poses[0].base_from_flange.translation().y(), -391.619027, 1e-9);
}

TEST(PoseFile, ReadsThePosesOfAViSPHandEye) {
  const fs::path folder = fs::path(GLINT_SHARED_DIR) / "data/field/handeye_franka";
  if (!fs::exists(folder)) {
    GTEST_SKIP() << "no " << folder;
  }
  std::vector<fs::path> files;
  for (int i = 1; i <= 8; ++i) {
    files.push_back(folder / fmt::format("franka_pose_rPe_{}.yaml", i));
  }
  const RobotPoses poses = read_poses(files, {});
  ASSERT_EQ(poses.poses.size(), 8U);
  EXPECT_EQ(poses.poses[7].name, "franka_pose_rPe_8");
  EXPECT_EQ(poses.convention.unit, PoseUnit::kMetre);
  EXPECT_EQ(poses.convention.rotation, PoseRotation::kRotationVector);
  EXPECT_NEAR(poses.poses[0].base_from_flange.translation().x(), 335.091, 1e-9);
  const Eigen::AngleAxisd turn(poses.poses[0].base_from_flange.linear());
  // |(-3.01226, 0.0236777, -0.451343)| = sqrt(9.07371 + 0.00056 + 0.20371) = 3.04598.
  EXPECT_NEAR(turn.angle(), 3.04598, 1e-5);
}

}  // namespace
}  // namespace glint
