// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --cell` with twins that show a board: the hidden hand-eye is found.
#include <cmath>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/acquire/gallery_cell.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kBoard = R"([board]
cols = 8
rows = 6
square_mm = 4.4
mark = true
setup = "eye_in_hand"
)";

/// From one text up to another, without it.
std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  const std::size_t end = text.find(to, begin);
  EXPECT_NE(end, std::string::npos) << from << " ... " << to;
  return text.substr(begin, end - begin);
}

/// The gallery's cell with a board in the place of its part, and a sharp lens.
void write_board_cell(const TemporaryFolder& folder) {
  write_file(folder / "board.toml", kBoard);
  json_of(folder, {"calibrate", "--print_board", "board.toml", "--out", "board"});
  const std::string truth = read_file(kGalleryCell / "truth.toml");
  write_file(
      folder / "board/truth.toml",
      "schema = 1\n" + read_file(folder / "board/board_part.toml") +
          with_three_quarters(between(truth, "[camera]", "[lens]")) +
          between(truth, "[sensor]", "[defects.dent]") +
          edited(truth.substr(truth.find("[lighting.ring]")), {{"samples = 8", "samples = 6"}}));
  write_file(
      folder / "cell.toml",
      edited(fast_cell("board/truth.toml"), {{"lights = [\"bar\"]", "lights = [\"ring\"]"}}) +
          "\n[[obstacle]]\nname = \"post\"\nposition_mm = [280, -20, 70]\n"
          "size_mm = [20, 20, 140]\n");
}

/// The status is what the rounds say: 0.3 px were asked for, in four rounds at most.
void expect_right_status(const json& told) {
  const std::size_t count = told["rounds"].size();
  const auto error_px = [&told](std::size_t round) {
    return told["rounds"][round]["point_error_px"].get<double>();
  };
  std::string status = "no_pose_reached";
  if (error_px(count - 1) <= 0.3) {
    status = "good";
  } else if (count == 4) {
    status = "max_rounds";
  } else if (count > 1 && error_px(count - 1) > 0.9 * error_px(count - 2)) {
    status = "no_pose_helps";
  }
  EXPECT_EQ(told["status"], status) << told["rounds"];
  EXPECT_EQ(told["ok"], status == "good");
}

void start_twins(const TemporaryFolder& folder) {
  json_of(folder,
          {"cell",
           "twin",
           "both",
           "cell.toml",
           "--port",
           "0",
           "--detach",
           "--ready_file",
           "twin.json"});
}

ProgramResult calibrate(const TemporaryFolder& folder) {
  return glint_in(folder, driving({"calibrate", "--board", "board.toml", "--out", "out"}));
}

void expect_refused(const TemporaryFolder& folder, const std::string& why) {
  const ProgramResult result = calibrate(folder);
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_THAT(result.err, HasSubstr(why));
}

json told_by_same_command(const TemporaryFolder& folder) {
  const ProgramResult result = calibrate(folder);
  EXPECT_THAT(result.code, testing::AnyOf(0, 1)) << result.err;
  return json::parse(result.out, nullptr, false);
}

/// The second round as a robot that stopped at its end leaves it.
void interrupt_second_round(const TemporaryFolder& folder) {
  const fs::path file = folder / "out/round_2/acquired.json";
  json acquired = json::parse(read_file(file));
  acquired["status"] = "stopped";
  write_file(file, acquired.dump());
}

/// After a calibration that ended in its rounds: the same command in a cell that has changed.
void expect_resumed(const TemporaryFolder& folder, const json& told) {
  const std::string cell = read_file(folder / "cell.toml");
  const std::string wall =
      "\n[[obstacle]]\nname = \"wall\"\nposition_mm = [300, 0, 100]\nsize_mm = [400, 400, 300]\n";
  start_twins(folder);
  write_file(folder / "cell.toml", cell + wall);
  const json whole = told_by_same_command(folder);  // neither planned nor driven again
  EXPECT_EQ(whole["rounds"], told["rounds"]) << whole;
  interrupt_second_round(folder);
  expect_refused(folder, "no longer free");
  // What would be planned now begins at another safe position.
  const std::string beside =
      "[[safe_position]]\nname = \"beside\"\n"
      "joints_deg = [12, -82.466, -92.57, -94.964, 90.0, -81.127]\n\n";
  write_file(folder / "cell.toml",
             std::string(cell).insert(cell.find("[[safe_position]]"), beside));
  const json resumed = told_by_same_command(folder);
  EXPECT_NE(resumed.value("status", "stopped"), "stopped") << resumed;
  glint_in(folder, {"cell", "twin", "stop", "twin.json"});
  interrupt_second_round(folder);
  fs::remove(folder / "out/plan_2/tour.json");
  expect_refused(folder, "an earlier program began this round");
}

TEST(CalibrateCell, FindsTheHiddenHandEye) {
  const TemporaryFolder folder;
  write_board_cell(folder);
  start_twins(folder);
  const ProgramResult result = calibrate(folder);
  glint_in(folder, {"cell", "twin", "stop", "twin.json"});
  ASSERT_THAT(result.code, testing::AnyOf(0, 1)) << result.err;
  const json told = json::parse(result.out);
  ASSERT_GE(told["rounds"].size(), 2U) << result.out;
  expect_right_status(told);
  const json second = json::parse(read_file(folder / "out/round_2/acquired.json"));
  EXPECT_EQ(second["counts"]["wanted"], 8) << "others took the place of those that were refused";
  EXPECT_THAT(told["refused"].dump(), HasSubstr("comes nearer than 5 mm to the post"));
  EXPECT_LT(told["rounds"].back()["point_error_px"], told["rounds"][0]["point_error_px"]);
  const json calibration = json::parse(read_file(folder / "out/calibration/calibration.json"));
  const json& hand_eye = calibration["hand_eye"];
  const json truth = {0.4, 50.2, 29.7};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(hand_eye["translation_mm"][i].get<double>(), truth[i].get<double>(), 0.5);
  }
  expect_resumed(folder, told);
}

}  // namespace
}  // namespace glint::test
