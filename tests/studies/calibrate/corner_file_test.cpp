// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/corner_file.h"

#include <string>

#include "tests/studies/calibrate/calibrate_fixture.h"

namespace glint::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// What is read of a picture without corners in a table of before, which has no column outcome.
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

TEST(CornerFile, TheOutcomeIsAColumnAndNotReadFromTheReason) {
  CalibrateInput input = {.width_px = 640, .height_px = 480, .names = {"a.png", "b.png"}};
  input.views = {{.outcome = BoardOutcome::kDark, .why = "blurred: by hand"},
                 {.outcome = BoardOutcome::kCutOff}};
  input.corners.resize(2);
  SolvedCalibration solved;
  solved.camera.pictures.resize(2);
  const std::string text = corners_csv(input, solved, {{}, {}});
  EXPECT_THAT(text, HasSubstr("a.png,640,480,,,,,,,no,dark,blurred: by hand,\n"));
  EXPECT_THAT(text, HasSubstr("b.png,640,480,,,,,,,no,cut off,,\n"));
  const FoundCorners found = parse_corners(text, "corners.csv");
  ASSERT_EQ(found.views.size(), 2U);
  EXPECT_EQ(found.views[0].outcome, BoardOutcome::kDark);
  EXPECT_EQ(found.views[0].why, "blurred: by hand");
  EXPECT_EQ(found.views[1].outcome, BoardOutcome::kCutOff);
  EXPECT_EQ(found.views[1].why, "");
}

TEST(CornerFile, AnotherOutcomeOfAPictureWithoutCornersIsRefused) {
  const std::string head =
      "picture,width_px,height_px,board_x_mm,board_y_mm,x_px,y_px,outcome,reason\n";
  for (const std::string word : {"", "accepted", "darkroom"}) {
    try {
      parse_corners(head + "a.png,640,480,,,,," + word + ",dark\n", "corners.csv");
      ADD_FAILURE() << word;
    } catch (const ConfigError& error) {
      EXPECT_THAT(error.what(), StartsWith("corners.csv:2:19: outcome: is \"" + word + "\""));
    }
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
