// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/corner_file.h"

#include <string>

#include "tests/studies/calibrate/calibrate_fixture.h"

namespace glint::test {
namespace {

/// What is read of a picture without corners whose reason is this.
BoardView view_of(const std::string& reason) {
  const std::string head =
      "picture,width_px,height_px,board_x_mm,board_y_mm,x_px,y_px,error_x_px,error_y_px,used,"
      "reason,orientation\n";
  return parse_corners(head + "a.png,640,480,,,,,,,no," + reason + ",\n", "corners.csv").views[0];
}

TEST(CornerFile, ReasonsAreReadAsTheyWereWritten) {
  EXPECT_EQ(view_of("dark").outcome, BoardOutcome::kDark);
  EXPECT_EQ(view_of("dark").why, "");
  EXPECT_EQ(view_of("dark: white is 3 % of full scale").outcome, BoardOutcome::kDark);
  EXPECT_EQ(view_of("dark: white is 3 % of full scale").why, "white is 3 % of full scale");
  EXPECT_EQ(view_of("cut off: at the left").outcome, BoardOutcome::kCutOff);
}

/// A name that begins another word is not that name.
TEST(CornerFile, WordsThatBeginAlikeAreNoReasons) {
  for (const char* text : {"darkroom door open", "doubled-up sheet", "blurred; by hand"}) {
    EXPECT_EQ(view_of(text).outcome, BoardOutcome::kNoBoard) << text;
    EXPECT_EQ(view_of(text).why, text);
  }
}

/// Corners that were found before know their board.
TEST_F(CalibrateVerb, CornersOfAnotherBoardAreTold) {
  if (board_on_robot().result.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  write_file(folder_ / "larger.toml",
             "[board]\ncols = 9\nrows = 7\nsquare_mm = 12\nsetup = \"eye_to_hand\"\n");
  const std::string corners = (board_on_robot().folder / "out/corners.csv").string();
  expect_refused({},
                 {"--from",
                  corners,
                  "--board",
                  "larger.toml",
                  "--poses",
                  (photographs("calibration/board_on_robot") / "poses.csv").string()},
                 "squares of 12 mm): its corners were found with another board");
}

}  // namespace
}  // namespace glint::test
