// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint calibrate` refuses: one line, exit code 2 or 3, nothing left behind.
#include "core/image/image_io.h"
#include "tests/studies/calibrate/calibrate_fixture.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

class CalibrateErrors : public CalibrateVerb {
 protected:
  CalibrateErrors() {
    write_file(folder_ / "board.toml", "[board]\ncols = 9\nrows = 6\nsquare_mm = 25\n");
    write_png(folder_ / "grey1.png", ImageF(80, 60, 0.5F), PixelDepth::k8Bit);
    write_png(folder_ / "grey2.png", ImageF(80, 60, 0.5F), PixelDepth::k8Bit);
    write_png(folder_ / "small.png", ImageF(40, 60, 0.5F), PixelDepth::k8Bit);
  }
};

TEST_F(CalibrateErrors, PicturesAndBoardMustBeGiven) {
  expect_refused({}, {"--board", "board.toml"}, "PICTURES: there are none");
  expect_refused({"grey1.png"}, {}, "--board: is missing");
  expect_refused({"none.png"}, {"--board", "board.toml"}, "none.png", 3);
  expect_refused({"grey1.png"}, {"--board", "none.toml"}, "none.toml", 3);
  write_file(folder_ / "broken.png", "no picture");
  expect_refused({"broken.png"}, {"--board", "board.toml"}, "broken.png");
}

TEST_F(CalibrateErrors, BoardFilesTellTheirPlace) {
  write_file(folder_ / "bad.toml", "[board]\ncols = 2\nrows = 6\nsquare_mm = 25\n");
  expect_refused({"grey1.png"}, {"--board", "bad.toml"}, "bad.toml:2:");
}

TEST_F(CalibrateErrors, PicturesOfOneCameraHaveOneSize) {
  expect_refused({"grey1.png", "small.png"},
                 {"--board", "board.toml"},
                 "small.png: has 40 x 60 pixels, grey1.png has 80 x 60");
}

TEST_F(CalibrateErrors, SomePictureMustShowTheBoard) {
  expect_refused({"grey1.png", "grey2.png"},
                 {"--board", "board.toml"},
                 "no picture shows the whole board of 9 x 6 corners; grey1.png: ");
}

TEST_F(CalibrateErrors, EveryPictureHasAPose) {
  write_file(folder_ / "poses.csv", "grey1.png,100,200,300,0,0,0.1\n");
  expect_refused(
      {"grey1.png", "grey2.png"}, {"--board", "board.toml", "--poses", "poses.csv"}, "grey2");
  expect_refused({"grey1.png"}, {"--board", "board.toml", "--poses", "none.csv"}, "none.csv", 3);
  write_file(folder_ / "nan.csv", "grey1.png,100,nan,300,0,0,0.1\n");
  expect_refused({"grey1.png"}, {"--board", "board.toml", "--poses", "nan.csv"}, "nan.csv:1:");
}

TEST_F(CalibrateErrors, WordsAreChecked) {
  write_file(folder_ / "poses.csv", "grey1.png,100,200,300,0,0,0.1\n");
  const Arguments poses = {"--board", "board.toml", "--poses", "poses.csv"};
  const auto with = [&](const Arguments& more) {
    Arguments all = poses;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  expect_refused({"grey1.png"}, with({"--setup", "hand"}), "--setup hand: must be eye_in_hand or");
  expect_refused({"grey1.png"}, with({"--method", "best"}), "--method best: must be one of tsai, ");
  expect_refused({"grey1.png"}, with({"--set", "unit=m"}), "must begin with \"convention.\"");
  expect_refused(
      {"grey1.png"}, {"--board", "board.toml", "--method", "park"}, "--method: needs --poses");
}

TEST_F(CalibrateErrors, APriorNeedsItsCamera) {
  const Arguments prior = {"--board", "board.toml", "--set", "prior.focal_px=5"};
  expect_refused({"grey1.png"}, prior, "--set: prior.focal_px: needs --camera");
  expect_refused({"grey1.png"},
                 {"--board", "board.toml", "--set", "convention.unit=m"},
                 "--set: convention.unit: needs --poses");
  write_file(folder_ / "camera.toml",
             "[camera]\nwidth_px = 80\nheight_px = 60\nfocal_x_px = 500\n");
  for (const auto& [set, told] :
       {std::pair("prior.focal_px=-1", "must be >= 0"), std::pair("prior.fx=1", "prior.fx")}) {
    expect_refused(
        {"grey1.png"}, {"--board", "board.toml", "--camera", "camera.toml", "--set", set}, told);
  }
}

TEST_F(CalibrateErrors, FilesOfOthersAreKept) {
  fs::create_directories(folder_ / "out");
  write_file(folder_ / "out/calibration.toml", "mine");
  const ProgramResult result = calibrate({"grey1.png"}, {"--board", "board.toml"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, ::testing::HasSubstr("holds a calibration.toml that is not of"));
  EXPECT_EQ(read_file(folder_ / "out/calibration.toml"), "mine");
}

TEST_F(CalibrateErrors, OnePictureDoesNotSuffice) {
  const fs::path set = photographs("calibration/chessboard_left");
  if (!fs::exists(set)) {
    GTEST_SKIP() << "no " << set;
  }
  expect_refused({(set / "left01.jpg").string()}, {"--board", "board.toml"}, "picture");
}

TEST_F(CalibrateErrors, ACameraOfAnotherSizeIsTold) {
  write_file(folder_ / "camera.toml",
             "[camera]\nwidth_px = 100\nheight_px = 60\nfocal_x_px = 500\n");
  expect_refused({"grey1.png"},
                 {"--board", "board.toml", "--camera", "camera.toml"},
                 "camera.toml: is a camera of 100 x 60 pixels, the pictures have 80 x 60");
}

}  // namespace
}  // namespace glint::test
