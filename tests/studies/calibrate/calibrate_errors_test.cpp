// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint calibrate` refuses: one line, exit code 2 or 3, nothing left behind.
#include <fmt/format.h>

#include "core/csv.h"
#include "core/image/image_io.h"
#include "core/text.h"
#include "studies/calibrate/calibrate_run.h"
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

/// A pose a line: place in mm, matrix row by row below each other, ... as the caller has it.
TEST_F(CalibrateErrors, PosesThatCannotBeAreTold) {
  const auto refused = [&](const std::string& name,
                           const std::string& text,
                           const std::string& message,
                           const std::vector<KeyValue>& sets = {}) {
    write_file(folder_ / name, text);
    const CalibrateOptions options = {.pictures = {"grey1.png", "grey2.png"},
                                      .board = "board.toml",
                                      .poses = {name},
                                      .out = "out",
                                      .sets = sets};
    expect_refused_here([&] { calibrate_pictures(options); }, message);
  };
  const std::string two = "grey1.png,300,10,500,0.1,0.2,0.3\ngrey2.png,310,20,480,0.4,0.2,0.1\n";
  refused("surplus.csv", two + "grey3.png,310,20,480,0,0,0.1\n", "grey3");
  refused("twice.csv", two + "grey2.png,310,20,480,0,0,0.1\n", "twice.csv:3:");
  refused("radians.csv",
          "grey1.png,300,10,500,90,0,20\ngrey2.png,310,20,480,80,0,10\n",
          "are they degrees?",
          {{"convention.angle", "rad"}, {"convention.rotation", "rotation_vector"}});
  refused("metres.csv",
          "grey1.png,0.3,0.1,0.5,0,0,0.1\ngrey2.png,0.3,0.2,0.4,0,0.1,0\n",
          "are they metres?",
          {{"convention.unit", "mm"}});
  refused("matrix.csv",
          "grey1.png,1,0,0,300, 0,1,0,10, 0,0,1.1,500\ngrey2.png,1,0,0,310, 0,1,0,20, 0,0,1,480\n",
          "matrix.csv:1:1: pose: its matrix is no rotation");
  refused("mirror.csv",
          "grey1.png,1,0,0,300, 0,1,0,10, 0,0,-1,500\ngrey2.png,1,0,0,310, 0,1,0,20, 0,0,1,480\n",
          "no rotation but a mirror");
  refused("stamps.csv",
          "name,stamp,x,y,z,a,b,c\ngrey1.png,5.0,300,10,500,0,0,0.1\n"
          "grey2.png,5.0,310,20,480,0,0.1,0\n",
          "is the stamp of an earlier pose");
  refused("text.csv", "grey1.png,300,ten,500,0,0,0.1\n", "text.csv:1:");
  refused("empty.csv", "", "empty.csv");
  refused("corrupt.json", "{\"poses\": [", "corrupt.json:1:");
  refused("poses.txt", two, "poses.txt");
}

TEST_F(CalibrateErrors, CorruptFilesAreToldWithTheirPlace) {
  const auto refused = [&](const std::string& option,
                           const std::string& name,
                           const std::string& text,
                           const std::string& message) {
    write_file(folder_ / name, text);
    CalibrateOptions options = {.board = "board.toml", .out = "out"};
    (option == "--board"  ? options.board
     : option == "--from" ? options.from
                          : options.camera) = name;
    if (option != "--from") {
      options.pictures = {"grey1.png"};
    }
    expect_refused_here([&] { calibrate_pictures(options); }, message);
  };
  refused("--board", "cut.toml", "[board\n", "cut.toml:1:");
  refused("--board", "cut.json", "{\"cols\": 9,", "cut.json:1:");
  refused("--camera", "cut.xml", "<root><camera>", "cut.xml:1:");
  refused("--camera", "cut.yaml", "camera_matrix: [1, 2", "cut.yaml:");
  refused("--from", "cut.csv", "picture,width_px\n", "cut.csv:1:1: has no column height_px");
  refused("--from",
          "number.csv",
          "picture,width_px,height_px,board_x_mm,board_y_mm,x_px,y_px\na.png,80,60,0,0,1,nan\n",
          "number.csv:2:19: y_px: must be a number");
  refused("--from",
          "sizes.csv",
          "picture,width_px,height_px,board_x_mm,board_y_mm,x_px,y_px\na.png,80,60,0,0,1,1\n"
          "b.png,80,61,0,0,1,1\n",
          "sizes.csv:3:7: width_px: pictures of one camera have one size");
  expect_refused({"grey1.png"},
                 {"--board", "board.toml", "--from", "sizes.csv"},
                 "--from: takes the corners of a file; give no PICTURES beside it");
}

/// None is left aside in silence, whether or not the files exist.
TEST_F(CalibrateErrors, OptionsOfOtherModesAreRefused) {
  const std::vector<std::pair<Arguments, std::string>> slips = {
      {{"--check", "C", "a.png", "--plan", "5"}, "--check takes no --plan"},
      {{"--check", "C", "a.png", "--place", "x.csv"}, "--check takes no --place"},
      {{"--plan", "5", "--place", "x.csv"}, "--plan takes no --place"},
      {{"--plan", "5", "--camera", "c.toml", "a.png"}, "--plan takes no PICTURES"},
      {{"--sensor", "D", "--points", "p.csv"}, "--sensor takes no --points"},
      {{"--sensor", "D", "--set", "plan.seed=2"}, "--sensor takes no --set"},
      {{"--print_board", "b.toml", "--method", "park"}, "--print_board takes no --method"},
      {{"--print_board", "b.toml", "--set", "plan.seed=2"}, "--print_board takes no --set"},
      {{"--place", "x.csv", "--from", "c.csv"}, "--place takes no --from"},
      {{"--points", "p.csv", "--board", "b.toml"}, "--points takes no --board"},
      {{"--cell", "cell.toml", "a.png"}, "--cell takes no PICTURES"},
      {{"--cell", "cell.toml", "--poses", "p.csv"}, "--cell takes no --poses"},
      {{"--cell", "cell.toml", "--set", "convention.unit=m"}, "--cell takes no --set"},
      {{"--cell", "cell.toml", "--check", "C"}, "--cell takes no --check"},
      {{"a.png", "--bits", "8"}, "--bits: needs --sensor"},
      {{"a.png", "--move"}, "--move: needs --cell"},
      {{"a.png", "--placements", "3"}, "--placements: needs --cell"},
      {{"--check", "C", "a.png", "--move"}, "--check takes no --move"}};
  std::vector<Arguments> calls;
  for (const auto& [arguments, message] : slips) {
    calls.push_back(arguments);
    calls.back().insert(calls.back().begin(), "calibrate");
  }
  auto slip = slips.begin();
  for (const ProgramResult& result : glint_at_once(folder_, calls)) {
    EXPECT_EQ(result.code, 2) << slip->second << "\n" << result.err;
    EXPECT_THAT(result.err, ::testing::HasSubstr((slip++)->second));
    EXPECT_EQ(std::ranges::count(result.err, '\n') + std::ssize(result.out), 1) << result.err;
  }
}

TEST_F(CalibrateErrors, ModesTakeTheirOwnOptionsOnly) {
  write_file(folder_ / "camera.toml", "[camera]\nwidth_px = 80\nheight_px = 60\nfocal_x_px = 90\n");
  expect_refused({}, {"--check", "none.json"}, "--check takes no --out");
  write_file(folder_ / "other.json", "{\"rms_px\": 1}");
  const auto without_out = [&](const Arguments& arguments, const std::string& message) {
    Arguments all = {"calibrate"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ProgramResult result = glint_in(folder_, all);
    EXPECT_EQ(result.code, 2) << result.err;
    EXPECT_THAT(result.err, ::testing::HasSubstr(message));
  };
  EXPECT_EQ(glint_in(folder_, {"calibrate", "--check", "none.json", "grey1.png"}).code, 3);
  without_out({"--check", "other.json", "grey1.png"}, "is no calibration.json of glint");
  without_out({"--check", "other.json", "--camera", "camera.toml"}, "--check takes no --camera");
  expect_refused({"grey1.png"}, {"--sensor", "."}, "--sensor takes no PICTURES");
  expect_refused({}, {"--sensor", "."}, "holds neither levels.csv");
  expect_refused({}, {"--bits", "8"}, "--bits: needs --sensor");
  expect_refused({}, {"--plan", "5", "--board", "board.toml"}, "--camera: is missing");
  expect_refused(
      {},
      {"--plan", "5", "--board", "board.toml", "--camera", "camera.toml", "--set", "seed=2"},
      "must begin with \"plan.\"");
  write_file(folder_ / "points.csv", "name,x_mm,y_mm\na,1,2\n");
  expect_refused({"grey1.png"}, {"--points", "points.csv"}, "--camera: is missing");
  expect_refused({"grey1.png"},
                 {"--points", "points.csv", "--camera", "other.json"},
                 "points.csv:1:1: has no column z_mm");
  expect_refused({"grey1.png"},
                 {"--points", "points.csv", "--camera", "other.json", "--set", "seed=2"},
                 "--set: seed: must begin with \"convention.\"");
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
  expect_refused(
      {(set / "left01.jpg").string()}, {"--board", "board.toml"}, "at least 3 are needed");
}

TEST_F(CalibrateErrors, AnotherBoardThanThePicturesShowIsTold) {
  const fs::path set = photographs("calibration/chessboard_left");
  if (!fs::exists(set)) {
    GTEST_SKIP() << "no " << set;
  }
  write_file(folder_ / "larger.toml", "[board]\ncols = 12\nrows = 9\nsquare_mm = 25\n");
  expect_refused(files_in(set, "left0", ".jpg"),
                 {"--board", "larger.toml"},
                 "no picture shows the whole board of 12 x 9 corners");
}

TEST_F(CalibrateErrors, ALargerBoardThanGivenIsTold) {
  const fs::path set = photographs("calibration/chessboard_left");
  if (!fs::exists(set)) {
    GTEST_SKIP() << "no " << set;
  }
  for (const char* size : {"cols = 8\nrows = 6", "cols = 9\nrows = 5", "cols = 6\nrows = 8"}) {
    write_file(folder_ / "smaller.toml", fmt::format("[board]\n{}\nsquare_mm = 25\n", size));
    expect_refused(files_in(set, "left", ".jpg"),
                   {"--board", "smaller.toml"},
                   "the board in the pictures is larger than smaller.toml says");
  }
}

/// The poses the wrong way round with a camera on the flange are those of one beside the robot.
TEST_F(CalibrateErrors, PosesTheWrongWayRoundAreToldWithBothReadings) {
  if (board_on_robot().result.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  const fs::path set = photographs("calibration/board_on_robot");
  expect_refused(
      {},
      {"--from",
       (board_on_robot().folder / "out/corners.csv").string(),
       "--board",
       (set / "board.json").string(),
       "--setup",
       "eye_in_hand",
       "--poses",
       (set / "poses.csv").string()},
      "they agree with --setup eye_to_hand, or, which no picture distinguishes from it, --set "
      "convention.direction=flange_from_base --setup eye_in_hand; the poses were read "
      "with unit = \"mm\": guessed");
}

TEST_F(CalibrateErrors, PosesThatContradictThePicturesAreTold) {
  const fs::path set = photographs("calibration/board_on_robot");
  if (!fs::exists(set)) {
    GTEST_SKIP() << "no " << set;
  }
  const Arguments pictures = files_in(set, "img", ".png");
  // Every picture gets the pose of another one.
  expect_refused({pictures.rbegin(), pictures.rend()},
                 {"--board",
                  (set / "board.json").string(),
                  "--poses",
                  (set / "poses.csv").string(),
                  "--set",
                  "poses.pair_by=order"},
                 "robot poses and pictures contradict each other");
}

/// Good pictures with their own poses, of which there are too few.
TEST_F(CalibrateErrors, FiveGoodPicturesAreToldAsTooFew) {
  const fs::path set = photographs("calibration/board_on_robot");
  if (!fs::exists(set)) {
    GTEST_SKIP() << "no " << set;
  }
  Arguments pictures = eight_on_robot();
  pictures.resize(5);
  write_file(folder_ / "five.csv", poses_on_robot(pictures));
  expect_refused(pictures,
                 {"--board", (set / "board.json").string(), "--poses", "five.csv"},
                 "the focal length stays unknown by");
}

TEST_F(CalibrateErrors, SquaresOfAnotherSizeAreToldByHowMuch) {
  const fs::path set = photographs("calibration/board_on_robot");
  if (!fs::exists(set)) {
    GTEST_SKIP() << "no " << set;
  }
  // They are of 10 mm: 0.833 times as large.
  write_file(folder_ / "larger.toml",
             "[board]\ncols = 9\nrows = 7\nsquare_mm = 12\nsetup = \"eye_to_hand\"\n");
  const Arguments pictures = files_in(set, "img", ".png");
  const std::string poses = (set / "poses.csv").string();
  expect_refused(pictures,
                 {"--board", "larger.toml", "--poses", poses},
                 "the robot's motion says that the board's squares are 0.83");
  write_file(folder_ / "little.toml",
             "[board]\ncols = 9\nrows = 7\nsquare_mm = 10.15\nsetup = \"eye_to_hand\"\n");
  expect_refused(
      pictures, {"--board", "little.toml", "--poses", poses}, "mm instead of 10.15 mm, more than");
}

TEST_F(CalibrateErrors, ACameraOfAnotherSizeIsTold) {
  write_file(folder_ / "camera.toml",
             "[camera]\nwidth_px = 100\nheight_px = 60\nfocal_x_px = 500\n");
  expect_refused({"grey1.png"},
                 {"--board", "board.toml", "--camera", "camera.toml"},
                 "camera.toml: is a camera of 100 x 60 pixels, the pictures have 80 x 60");
}

// The pictures of a chessboard, from left08 on as a camera with a lens 1.15 times as long would
// have taken them.
TEST_F(CalibrateErrors, PicturesOfTwoCamerasAreToldWithTheirPlace) {
  if (chessboard("left").result.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  const auto rows =
      parse_csv(read_file(chessboard("left").folder / "out/corners.csv"), "corners.csv");
  std::string two;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<std::string> fields;
    for (const CsvField& field : rows[i]) {
      fields.push_back(field.text);
    }
    if (i > 0 && std::filesystem::path(fields[0]).filename() >= "left08.jpg") {
      fields[5] = shortest(320.0 + 1.15 * (*rows[i][5].number() - 320.0));
      fields[6] = shortest(240.0 + 1.15 * (*rows[i][6].number() - 240.0));
    }
    two += csv_row(fields);
  }
  write_file(folder_ / "two.csv", two);
  const std::string board = (photographs("calibration/chessboard_left") / "board.json").string();
  expect_refused(
      {},
      {"--from", "two.csv", "--board", board},
      "two cameras, or of one whose lens was turned in between: left01.jpg to left07.jpg "
      "agree among each other, and so do left08.jpg to left14.jpg, with 1.1");
}

/// Two real cameras whose pictures have one size: one after the other, and by turns.
TEST_F(CalibrateErrors, PicturesOfTwoRealCamerasAreTold) {
  const fs::path left = photographs("calibration/chessboard_left");
  const fs::path arm = photographs("field/handeye_franka");
  if (!fs::exists(left) || !fs::exists(arm)) {
    GTEST_SKIP() << "no photographs";
  }
  Arguments row = files_in(left, "left", ".jpg");
  const Arguments others = files_in(arm, "franka_image-", ".png");
  Arguments turns;
  for (std::size_t i = 0; i < row.size(); ++i) {
    turns.push_back(row[i]);
    if (i < others.size()) {
      turns.push_back(others[i]);
    }
  }
  row.insert(row.end(), others.begin(), others.end());
  expect_refused(row,
                 {"--board", "board.toml"},
                 "left01.jpg to left14.jpg agree among each other, and so do franka_image-1.png "
                 "to franka_image-8.png");
  expect_refused(turns, {"--board", "board.toml"}, "the pictures are of two cameras");
  const std::string camera = (arm / "franka_camera.xml").string();
  expect_refused(
      row, {"--board", "board.toml", "--camera", camera}, "the pictures are of two cameras");
  const auto warnings_of = [&](const Arguments& pictures) {
    return calibrate_json(pictures, {"--board", "board.toml", "--camera", camera})["warnings"]
        .dump();
  };
  EXPECT_THAT(warnings_of(others), ::testing::Not(::testing::HasSubstr("do not fit")));
  fs::remove_all(folder_ / "out");
  EXPECT_THAT(warnings_of(files_in(left, "left", ".jpg")),
              ::testing::HasSubstr("--camera: its numbers do not fit these pictures"));
}

// Half of the pictures of a robot with its board pushed by 15 mm in its grip: as if the flange had
// been elsewhere.
TEST_F(CalibrateErrors, ABoardThatMovedMidwayIsToldWithTheTwoPictures) {
  if (board_on_robot().result.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  const fs::path set = photographs("calibration/board_on_robot");
  const auto rows = parse_csv(read_file(set / "poses.csv"), "poses.csv");
  std::string moved;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<std::string> fields;
    for (const CsvField& field : rows[i]) {
      fields.push_back(field.text);
    }
    for (std::size_t row = 0; row < 3 && i >= rows.size() / 2; ++row) {
      const double x = *rows[i][1 + 4 * row].number();
      fields[4 + 4 * row] = shortest(*rows[i][4 + 4 * row].number() + 15.0 * x);
    }
    moved += csv_row(fields);
  }
  write_file(folder_ / "moved.csv", moved);
  expect_refused({},
                 {"--from",
                  (board_on_robot().folder / "out/corners.csv").string(),
                  "--board",
                  (set / "board.json").string(),
                  "--poses",
                  "moved.csv"},
                 "moved between pictures img09.png and img10.png");
}

}  // namespace
}  // namespace glint::test
