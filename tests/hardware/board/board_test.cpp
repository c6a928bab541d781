// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/board.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "core/file.h"
#include "hardware/board/board_view.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string board_error(const std::string& text) {
  try {
    parse_board_json(text, "b.json");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Board, IsReadFromJson) {
  const Board board =
      parse_board_json(R"({"cols": 9, "rows": 7, "square_mm": 10.0, "setup": "eye_to_hand"})", "b");
  EXPECT_EQ(board.cols, 9);
  EXPECT_EQ(board.setup, BoardSetup::kEyeToHand);
  EXPECT_EQ(num_corners(board), 63);
  EXPECT_EQ(parse_board_json(R"({"board": {"cols": 4, "rows": 3, "square_mm": 5}})", "b").rows, 3);
}

TEST(Board, IsWrittenAsTomlThatReadsBackAsTheSame) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "board.toml";
  const Board checkerboard = {.cols = 11, .rows = 8, .square_mm = 6.6, .mark = true};
  const Board charuco = {.kind = BoardKind::kCharuco,
                         .cols = 5,
                         .rows = 4,
                         .square_mm = 30.0,
                         .marker_mm = 20.0,
                         .dictionary = MarkerDictionary::k6x6,
                         .setup = BoardSetup::kEyeInHand};
  for (const Board& board : {checkerboard, charuco}) {
    write_file(file, board_toml(board));
    EXPECT_EQ(board_toml(read_board(file)), board_toml(board));
  }
  EXPECT_EQ(read_board(file).dictionary, MarkerDictionary::k6x6);
  EXPECT_EQ(read_board(file).marker_mm, 20.0);
}

TEST(Board, TellsWhereItsFileIsWrong) {
  EXPECT_THAT(board_error("{\"cols\": 2, \"rows\": 7, \"square_mm\": 1}"),
              HasSubstr("b.json:1:10: cols: is 2, must be in [3, 100]"));
  EXPECT_THAT(board_error("{\"cols\": 9,\n \"row\": 7, \"square_mm\": 1}"),
              HasSubstr("b.json:2:9: row: unknown key, the nearest known one is \"rows\""));
  EXPECT_THAT(board_error("{\"cols\": 9, \"rows\": 7}"), HasSubstr("square_mm: is missing"));
  EXPECT_THAT(board_error("{\"cols\": 9, \"rows\": 7, \"square_mm\": 0}"),
              HasSubstr("must be in (0, "));
  EXPECT_THAT(board_error(R"({"cols": 9, "rows": 7, "square_mm": 9, "marker_mm": 5})"),
              HasSubstr("marker_mm: is for kind = \"charuco\""));
  EXPECT_THAT(
      board_error(R"({"kind": "charuco", "cols": 9, "rows": 7, "square_mm": 9, "marker_mm": 9})"),
      HasSubstr("must be below 0.95 of square_mm"));
  EXPECT_THAT(
      board_error(R"({"kind": "charuco", "cols": 9, "rows": 7, "square_mm": 9, "mark": true})"),
      HasSubstr("mark: is for checkerboards"));
  EXPECT_THAT(board_error("[1]"), HasSubstr("b.json:1:1: "));
  EXPECT_THROW(read_board("board.txt"), ConfigError);
  EXPECT_THROW(read_board("no_such_board.json"), IoError);
}

TEST(Board, HasItsCornersRowByRow) {
  const Board board = {.cols = 4, .rows = 3, .square_mm = 5.0};
  const std::vector<Eigen::Vector3d> corners = corners_mm(board);
  ASSERT_EQ(corners.size(), 12U);
  EXPECT_EQ(corners[0], Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(corners[6], Eigen::Vector3d(10, 5, 0));  // row 1, column 2
}

TEST(Board, KnowsWhetherItsFirstCornerCanBeTold) {
  // 10 x 7 squares: opposite corners differ in colour. 11 x 9: they do not. 9 x 9: no corner does.
  EXPECT_EQ(num_symmetries({.cols = 9, .rows = 6}), 1);
  EXPECT_EQ(num_symmetries({.cols = 10, .rows = 8}), 2);
  EXPECT_EQ(num_symmetries({.cols = 8, .rows = 8}), 4);
  EXPECT_EQ(num_symmetries({.cols = 7, .rows = 7}), 2);
  EXPECT_EQ(num_symmetries({.cols = 10, .rows = 8, .mark = true}), 1);
  EXPECT_EQ(num_symmetries({.kind = BoardKind::kCharuco, .cols = 10, .rows = 8}), 1);
}

TEST(Board, DataSetsAreRead) {
  const fs::path folder = fs::path(GLINT_SHARED_DIR) / "data/calibration";
  if (!fs::exists(folder)) {
    GTEST_SKIP() << "no " << folder;
  }
  EXPECT_EQ(read_board(folder / "board_on_robot/board.json").square_mm, 10.0);
  EXPECT_EQ(read_board(folder / "chessboard_left/board.json").setup, BoardSetup::kNone);
}

TEST(RejectDoubled, RejectsTheLaterOfTwoEqualViews) {
  const auto view = [](double x) {
    return BoardView{.outcome = BoardOutcome::kAccepted,
                     .board_mm = {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0)},
                     .picture_px = {Eigen::Vector2d(x, 5), Eigen::Vector2d(x + 9, 5)}};
  };
  std::vector<BoardView> views = {view(10.0), view(10.3), view(10.05)};
  reject_doubled(views, {"a", "b", "c"});
  EXPECT_TRUE(views[0].is_accepted());
  EXPECT_TRUE(views[1].is_accepted());
  EXPECT_EQ(views[2].outcome, BoardOutcome::kDoubled);
  EXPECT_EQ(views[2].why, "shows the same view as a");
  EXPECT_EQ(outcome_name(views[2].outcome), "doubled");
}

}  // namespace
}  // namespace glint
