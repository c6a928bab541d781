// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate` on photographs by others, and what its files are good for.
#include <cmath>
#include <regex>
#include <set>

#include <fmt/format.h>

#include "core/config/keys.h"
#include "core/config/toml.h"
#include "hardware/board/board.h"
#include "simulator/camera/camera_settings.h"
#include "tests/studies/calibrate/calibrate_fixture.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;
using ::testing::HasSubstr;

std::set<std::string> rejected(const Json& result) {
  std::set<std::string> names;
  for (const Json& picture : result["pictures"]) {
    if (!picture["accepted"].get<bool>()) {
      names.insert(fs::path(picture["file"].get<std::string>()).filename().string());
      EXPECT_NE(picture["reason"], "");
    }
  }
  return names;
}

TEST_F(CalibrateVerb, AcceptsAllOfAChessboardAndWritesACameraForScenes) {
  const fs::path set = photographs("calibration/chessboard_left");
  if (!fs::exists(set)) {
    GTEST_SKIP() << "no " << set;
  }
  const Json& result = chessboard("left").result;
  EXPECT_EQ(result["status"], "done");
  EXPECT_EQ(result["setup"], "none");
  EXPECT_EQ(result["pictures"].size(), 13U);
  EXPECT_EQ(rejected(result), std::set<std::string>());
  EXPECT_EQ(result["hand_eye"], nullptr);
  // OpenCV's own sample gives 536 px for this camera.
  EXPECT_NEAR(result["intrinsics"]["focal_px"][0].get<double>(), 536.0, 5.0);
  EXPECT_LT(result["rms_px"].get<double>(), 0.3);
  EXPECT_GE(result["prediction_rms_px"].get<double>(), result["rms_px"].get<double>());
  EXPECT_LT(result["prediction_rms_px"].get<double>(), 0.4);

  for (const Json& picture : result["pictures"]) {
    EXPECT_GT(picture["influence"]["cook"].get<double>(), 0.0) << picture;
  }
  ASSERT_EQ(result["next"]["views"].size(), 3U);
  EXPECT_LT(result["next"]["views"][0]["point_error_px"].get<double>(),
            result["next"]["point_error_px"].get<double>());
  EXPECT_THAT(result["next"]["views"][0]["text"].get<std::string>(), HasSubstr("the board "));

  const fs::path out = chessboard("left").folder / "out";
  const Json written = Json::parse(read_file(out / "calibration.json"));
  EXPECT_EQ(written["intrinsics"], result["intrinsics"]);
  EXPECT_EQ(Json::parse(read_file(out / "run.json"))["verb"], "calibrate");
  const ConfigNode root = load_toml(out / "calibration.toml");
  CameraSettings camera;
  std::vector<Problem> errors;
  KeyReader reader(root.find("camera"), "camera", errors);
  visit_keys(reader, camera);
  reader.report_unknown();
  EXPECT_TRUE(errors.empty()) << (errors.empty() ? "" : errors.front().message());
  const PinholeIntrinsics read = intrinsics_of(camera);
  EXPECT_EQ(read.width_px, 640);
  EXPECT_EQ(read.focal_px.x(), result["intrinsics"]["focal_px"][0].get<double>());
  EXPECT_EQ(read.center_px.y(), result["intrinsics"]["center_px"][1].get<double>());
  EXPECT_EQ(read.tangential[1], result["intrinsics"]["tangential"][1].get<double>());
}

TEST_F(CalibrateVerb, MakesASceneTakeTheCameraByInclude) {
  const fs::path set = photographs("calibration/chessboard_left");
  if (!fs::exists(set)) {
    GTEST_SKIP() << "no " << set;
  }
  fs::copy(chessboard("left0").folder / "out", folder_ / "out");
  const std::string study = small_study();
  // The scene's own size of a picture would win over the calibration's.
  const std::string own = edited(study, {{"width_px = 200\nheight_px = 60\n", ""}});
  write_file(folder_ / "scene.toml", "include = [\"out/calibration.toml\"]\n" + own);
  const ProgramResult masks =
      glint_in(folder_, {"render", "scene.toml", "--masks", "--out", "masks", "--quiet"});
  EXPECT_EQ(masks.code, 0) << masks.err;
  EXPECT_THAT(read_file(folder_ / "masks/study.resolved.toml"), HasSubstr("width_px = 640"));
}

TEST_F(CalibrateVerb, FindsTheCameraBesideARobot) {
  const Json& result = board_on_robot().result;
  if (result.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  EXPECT_EQ(result["setup"], "eye_to_hand");
  EXPECT_EQ(rejected(result), (std::set<std::string>{"img02.png", "img17.png"}));
  EXPECT_LE(result["prediction_rms_px"].get<double>(), 0.75);
  EXPECT_LE(result["prediction_5fold_rms_px"].get<double>(), 0.75);
  EXPECT_EQ(result["prediction_5fold_splits"], 20);
  EXPECT_EQ(result["hand_eye"]["from"], "camera");
  EXPECT_EQ(result["hand_eye"]["to"], "base");
  EXPECT_EQ(result["board"]["pose"]["to"], "flange");
  // What the rounds of a cell go by, beside which pictures are accepted.
  EXPECT_GT(result["hand_eye"]["sigma_mm"].get<double>(), 0.0);
  EXPECT_GT(result["hand_eye"]["sigma_deg"].get<double>(), 0.0);
  EXPECT_GT(result["point_error_px"]["rms"].get<double>(), 0.0);
  ASSERT_EQ(result["methods"].size(), 8U);
  EXPECT_EQ(result["methods"][0]["name"], "glint");
  for (std::size_t i = 1; i < 8; ++i) {
    const Json& method = result["methods"][i];
    if (method["failed"].get<bool>()) {
      continue;
    }
    for (const char* key : {"prediction_rms_px", "prediction_5fold_rms_px"}) {
      EXPECT_LE(result[key].get<double>(), method[key].get<double>() / 6.0) << method;
    }
  }
}

/// 0.3 % too large: no picture is rejected for it, and the camera is that of the true board.
TEST_F(CalibrateVerb, SquaresThatAreALittleOffAreTakenAndTold) {
  const Json& right = board_on_robot().result;
  if (right.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  const fs::path set = photographs("calibration/board_on_robot");
  write_file(folder_ / "off.toml",
             "[board]\ncols = 9\nrows = 7\nsquare_mm = 10.03\nsetup = \"eye_to_hand\"\n");
  const Json result = calibrate_json(
      files_in(set, "img", ".png"),
      with({"--board", "off.toml", "--poses", (set / "poses.csv").string()}, kOneSplit));
  EXPECT_TRUE(result["board"]["measured_scale"]["is_taken"].get<bool>());
  EXPECT_NEAR(result["board"]["square_mm"].get<double>(), 10.0, 0.015);
  EXPECT_EQ(result["board"]["given_square_mm"], 10.03);
  EXPECT_THAT(result["notes"].dump(), HasSubstr("they are taken so"));
  EXPECT_LE(result["prediction_rms_px"].get<double>(), 0.75);
  for (std::size_t i = 0; i < right["pictures"].size(); ++i) {
    EXPECT_EQ(result["pictures"][i]["accepted"], right["pictures"][i]["accepted"]) << i;
  }

  // The file that it was given stands for the board as it was measured.
  Arguments check = files_in(set, "img0", ".png");
  std::erase_if(check, [](const std::string& name) { return name.find("img02") != name.npos; });
  check.insert(check.begin(), "calibrate");
  std::string some = read_file(set / "poses.csv");
  some = std::regex_replace(some, std::regex("[^\n]*(img1|img02)[^\n]*\n"), "");
  write_file(folder_ / "some.csv", some);
  check.insert(check.end(), {"--check", "out", "--board", "off.toml", "--poses", "some.csv"});
  EXPECT_EQ(glint_in(folder_, check).code, 0);
}

/// A dot that no picture shows settles nothing.
TEST_F(CalibrateVerb, AMarkThatIsNotThereIsTold) {
  if (!fs::exists(photographs("calibration/board_on_robot"))) {
    GTEST_SKIP() << "no photographs";
  }
  const Arguments pictures = eight_on_robot();
  write_file(folder_ / "poses.csv", poses_on_robot(pictures));
  write_file(folder_ / "mark.toml",
             "[board]\ncols = 9\nrows = 7\nsquare_mm = 10\nmark = true\n"
             "setup = \"eye_to_hand\"\n");
  const Json result =
      calibrate_json(pictures, with({"--board", "mark.toml", "--poses", "poses.csv"}, kOneSplit));
  EXPECT_EQ(result["board"]["orientation"], "first picture");
  EXPECT_THAT(result["notes"].dump(), HasSubstr("pictures show the mark"));

  // From its corners alone the same is known.
  Arguments call = {"calibrate", "--from", "out/corners.csv", "--board", "mark.toml"};
  call = with(with(call, {"--poses", "poses.csv", "--out", "again"}), kOneSplit);
  const ProgramResult again = glint_in(folder_, call);
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("board's orientation: by the first picture"));
  const Json same = Json::parse(read_file(folder_ / "again/calibration.json"));
  EXPECT_EQ(same["board"]["orientation"], "first picture");
  EXPECT_EQ(same["hand_eye"], result["hand_eye"]);
  EXPECT_THAT(same["notes"].dump(), HasSubstr("pictures show the mark"));
}

/// Nor on a board whose colours settle it.
TEST_F(CalibrateVerb, AMarkThatIsNotThereIsToldOfAnOddBoard) {
  const fs::path set = photographs("calibration/chessboard_left");
  if (!fs::exists(set)) {
    GTEST_SKIP() << "no " << set;
  }
  write_file(folder_ / "mark.toml", "[board]\ncols = 9\nrows = 6\nsquare_mm = 25\nmark = true\n");
  const Json result = calibrate_json(files_in(set, "left0", ".jpg"), {"--board", "mark.toml"});
  EXPECT_FALSE(result["board"]["mark"].get<bool>());
  EXPECT_TRUE(result["board"]["given_mark"].get<bool>());
  EXPECT_THAT(result["notes"].dump(), HasSubstr("pictures show the mark"));
}

TEST_F(CalibrateVerb, CornersWhoseOrientationIsNoWordOrTwoAreRefused) {
  write_file(folder_ / "board.toml", "[board]\ncols = 9\nrows = 7\nsquare_mm = 10\n");
  const auto error_of = [&](const std::string& rows) {
    write_file(folder_ / "corners.csv",
               "picture,width_px,height_px,board_x_mm,board_y_mm,x_px,y_px,orientation\n" + rows);
    const ProgramResult result = calibrate({}, {"--from", "corners.csv", "--board", "board.toml"});
    EXPECT_EQ(result.code, 2);
    return result.err;
  };
  EXPECT_THAT(error_of("a.png,640,480,0,0,100,100,upright\n"),
              HasSubstr("corners.csv:2:27: orientation: is \"upright\""));
  EXPECT_THAT(
      error_of("a.png,640,480,0,0,100,100,known\na.png,640,480,10,0,120,100,unknown\n"),
      HasSubstr("corners.csv:3:28: orientation: must be the same in all rows of a picture"));
}

// The robot holds the board before the camera: a scene with a plate where the board is, seen at a
// pose of the flange.
TEST_F(CalibrateVerb, PlacesTheCameraOfASceneByTheFlange) {
  const Json& result = board_on_robot().result;
  if (result.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  fs::copy(board_on_robot().folder / "out", folder_ / "out");
  const ConfigNode root = load_toml(folder_ / "out/calibration.toml");
  EXPECT_EQ(root.find("schema")->integer, 2);
  EXPECT_EQ(root.at_path("calibration.setup")->text, "eye_to_hand");
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(
        root.at_path(fmt::format("calibration.base_from_camera.translation_mm.{}", i))->number,
        result["hand_eye"]["translation_mm"][i].get<double>());
  }
  // The square of the standard deviation of fx is the first number of its covariance.
  EXPECT_NEAR(std::sqrt(root.at_path("calibration.covariance.intrinsics.0")->number),
              result["intrinsics"]["sigma"]["focal_px"][0].get<double>(),
              1e-9);
  std::string scene =
      "include = [\"out/calibration.toml\"]\n[part]\nshape = \"plate\"\n"
      "length_mm = 90\nwidth_mm = 70\nthickness_mm = 2\n[[viewpoint]]\n"
      "[viewpoint.base_from_flange]\ntranslation_mm = [300, 0, 300]\n";
  write_file(folder_ / "scene.toml", scene);
  const Arguments masks = {"render", "scene.toml", "--masks", "--out", "masks", "--quiet"};
  const ProgramResult refused = glint_in(folder_, masks);
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err,
              HasSubstr("scene.toml:8:12: viewpoint.0.base_from_flange: needs "
                        "[cell.flange_from_part]"));
  write_file(folder_ / "scene.toml", scene + "[cell.flange_from_part]\n");
  const ProgramResult done = glint_in(folder_, masks);
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(read_file(folder_ / "masks/study.resolved.toml"),
              HasSubstr("[viewpoint.base_from_flange]"));
}

TEST_F(CalibrateVerb, FindsTheCameraOnAFrankaArm) {
  const fs::path set = photographs("field/handeye_franka");
  if (!fs::exists(set)) {
    GTEST_SKIP() << "no " << set;
  }
  write_file(folder_ / "board.toml", "[board]\ncols = 9\nrows = 6\nsquare_mm = 23.6\n");
  Arguments more = {
      "--board", "board.toml", "--camera", (set / "franka_camera.xml").string(), "--poses"};
  more = with(with(more, files_in(set, "franka_pose_rPe_", ".yaml")), kOneSplit);
  const Json& result = franka().result;
  EXPECT_EQ(result["setup"], "eye_in_hand");
  EXPECT_EQ(result["prediction_5fold_splits"], 1) << "as it was asked for";
  EXPECT_THAT(result["notes"].dump(), HasSubstr("setup = \\\"eye_in_hand\\\": guessed"));
  EXPECT_EQ(rejected(result), std::set<std::string>());
  EXPECT_EQ(result["intrinsics"]["focal_px"][0], 607.5931396484375);
  EXPECT_NEAR(result["hand_eye"]["scatter_deg"].get<double>(), 0.47, 0.03);
  EXPECT_NEAR(result["hand_eye"]["scatter_mm"].get<double>(), 5.42, 0.1);
  EXPECT_GT(result["noise"]["robot_mm"], 1.0);
  // The set's millimetres are named as the robot's, and what other squares would leave of them.
  EXPECT_THAT(result["notes"].dump(), HasSubstr("the errors are the robot's, not the camera's"));
  EXPECT_THAT(result["notes"].dump(), HasSubstr("mm instead of 23.6 mm would leave"));
  EXPECT_FALSE(result["board"]["measured_scale"]["is_taken"].get<bool>());

  Arguments with_prior = more;
  with_prior.insert(with_prior.end(), {"--set", "prior.focal_px=2", "--set", "prior.center_px=1"});
  const Json prior = calibrate_json(files_in(set, "franka_image-", ".png"), with_prior);
  const Json& lens = prior["intrinsics"];
  EXPECT_EQ(lens["free"], Json({"fx", "fy", "cx", "cy"}));
  EXPECT_NE(lens["focal_px"][0], 607.5931396484375);
  EXPECT_NEAR(lens["focal_px"][0].get<double>(), 607.593, 6.0);
  EXPECT_GT(lens["sigma"]["focal_px"][0].get<double>(), 0.1);
  EXPECT_LE(lens["sigma"]["focal_px"][0].get<double>(), 2.0);
  EXPECT_EQ(lens["radial"], Json({0.0, 0.0, 0.0}));

  fs::remove_all(folder_ / "out");
  more.insert(more.end(), {"--method", "park"});
  const Json park = calibrate_json(files_in(set, "franka_image-", ".png"), more);
  EXPECT_EQ(park["hand_eye"]["method"], "park");
  EXPECT_EQ(park["hand_eye"]["sigma_mm"], nullptr);
  EXPECT_NEAR(park["hand_eye"]["scatter_deg"].get<double>(), 0.458, 0.02);
  EXPECT_NEAR(park["hand_eye"]["scatter_mm"].get<double>(), 5.415, 0.06);
  EXPECT_EQ(park["point_error_px"]["rms"], nullptr);
  // Its own predictions of the pictures, of 54 corners each, and no figures of our solution.
  double square = 0.0;
  for (std::size_t i = 0; i < park["pictures"].size(); ++i) {
    const Json& picture = park["pictures"][i];
    square += std::pow(picture["prediction_px"].get<double>(), 2) / 8.0;
    EXPECT_EQ(picture["chi_square"], nullptr);
    EXPECT_EQ(picture["influence"], nullptr);
    EXPECT_NE(picture["rms_px"], result["pictures"][i]["rms_px"]);
  }
  EXPECT_NEAR(std::sqrt(square), park["prediction_rms_px"].get<double>(), 1e-5);
}

TEST_F(CalibrateVerb, PrintsABoard) {
  write_file(folder_ / "b.toml", "[board]\ncols = 10\nrows = 7\nsquare_mm = 12.5\nmark = true\n");
  const ProgramResult result =
      glint_in(folder_, {"calibrate", "--print_board", "b.toml", "--out", "out", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(Json::parse(result.out)["status"], "done");
  EXPECT_THAT(read_file(folder_ / "out/board.svg"), HasSubstr("<svg"));
  EXPECT_TRUE(read_file(folder_ / "out/board.pdf").starts_with("%PDF-1.4"));
  const Board board = read_board(folder_ / "out/board.toml");
  EXPECT_EQ(board.cols, 10);
  EXPECT_EQ(board.square_mm, 12.5);
  EXPECT_TRUE(board.mark);
  // The sheet as the part of a scene.
  write_file(folder_ / "scene.toml",
             "include = [\"out/board_part.toml\"]\n[camera]\nwidth_px = 80\nheight_px = 60\n"
             "object_pixel_mm = 2\n[lighting.ring]\nmount = \"camera\"\n[render.paths]\n"
             "samples = 1\n");
  const ProgramResult scene = glint_in(folder_, {"render", "scene.toml", "--quiet"});
  EXPECT_EQ(scene.code, 0) << scene.err;
}

TEST_F(CalibrateVerb, HasItsHelp) {
  const ProgramResult help = glint_in(folder_, {"help", "calibrate"});
  EXPECT_EQ(help.code, 0);
  for (const std::string option : {"PICTURES", "--board", "--poses", "--camera", "--print_board"}) {
    EXPECT_THAT(help.out, HasSubstr(option));
  }
  EXPECT_THAT(glint_in(folder_, {"help"}).out, HasSubstr("calibrate"));
}

}  // namespace
}  // namespace glint::test
