// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs of boards, made by others.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "hardware/board/find_board.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

/// Names of the pictures in a folder that were not accepted, each with its outcome.
std::set<std::string> rejected(const fs::path& folder, const Board& board, int expected) {
  std::set<std::string> result;
  int num_pictures = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string ending = entry.path().extension().string();
    if (ending != ".png" && ending != ".jpg") {
      continue;
    }
    ++num_pictures;
    const BoardView view = find_board(read_picture(entry.path()).pixels, board);
    if (!view.is_accepted()) {
      result.insert(entry.path().filename().string() + ": " + outcome_name(view.outcome));
    }
  }
  EXPECT_EQ(num_pictures, expected);
  return result;
}

TEST(RealBoards, AllOfTheChessboardAreAccepted) {
  const fs::path folder = fs::path(GLINT_SHARED_DIR) / "data/calibration/chessboard_left";
  if (!fs::exists(folder)) {
    GTEST_SKIP() << "no " << folder;
  }
  EXPECT_EQ(rejected(folder, read_board(folder / "board.json"), 13), std::set<std::string>());
}

TEST(RealBoards, OfTheBoardOnARobotTwoAreCutOff) {
  const fs::path folder = fs::path(GLINT_SHARED_DIR) / "data/calibration/board_on_robot";
  if (!fs::exists(folder)) {
    GTEST_SKIP() << "no " << folder;
  }
  const std::set<std::string> cut = {"img02.png: cut off", "img17.png: cut off"};
  EXPECT_EQ(rejected(folder, read_board(folder / "board.json"), 19), cut);
}

TEST(RealBoards, AllOfTheHandEyeSetAreAccepted) {
  const fs::path folder = fs::path(GLINT_SHARED_DIR) / "data/field/handeye_franka";
  if (!fs::exists(folder)) {
    GTEST_SKIP() << "no " << folder;
  }
  const Board board = {.cols = 9, .rows = 6, .square_mm = 23.6};
  EXPECT_EQ(rejected(folder, board, 8), std::set<std::string>());
}

}  // namespace
}  // namespace glint
