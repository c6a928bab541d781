// SPDX-License-Identifier: GPL-3.0-or-later
//
// What people see of a calibration: page, corners, check, straight pictures, plan, points.
#include <algorithm>
#include <array>
#include <cmath>
#include <regex>

#include <Eigen/Geometry>

#include "core/csv.h"
#include "core/image/exr_layers.h"
#include "core/image/image_io.h"
#include "simulator/camera/pinhole_camera.h"
#include "tests/studies/calibrate/calibrate_fixture.h"
#include "tests/support/page_data.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// Pictures of a chessboard by others, or none where they are not.
class CalibrateOutput : public CalibrateVerb {
 protected:
  void SetUp() override {
    if (!fs::exists(left_)) {
      GTEST_SKIP() << "no " << left_;
    }
  }

  Json result_of(const Arguments& arguments, int code = 0) const {
    Arguments all = arguments;
    all.emplace_back("--json");
    const ProgramResult result = glint_in(folder_, all);
    EXPECT_EQ(result.code, code) << result.err;
    return result.out.empty() ? Json() : Json::parse(result.out);
  }

  /// The calibration of pictures whose names begin so, its files in out/.
  Json calibrated(const std::string& begin) const {
    fs::copy(chessboard(begin).folder / "out", folder_ / "out");
    return chessboard(begin).result;
  }

  Json calibrated_left() const { return calibrated("left"); }

  const fs::path left_ = photographs("calibration/chessboard_left");
  const std::string board_ = (left_ / "board.json").string();
};

TEST_F(CalibrateOutput, PageHasVerdictPicturesAndWhatTheResultSays) {
  const Json result = calibrated_left();
  EXPECT_EQ(result["report"], "out/report.html");
  const auto data = page_data(read_file(folder_ / "out/report.html"));
  EXPECT_THAT(data["verdict"]["sentence"].get<std::string>(), HasSubstr("13 of 13 pictures agree"));
  ASSERT_EQ(data["calibration"]["pictures"].size(), 13U);
  for (const auto& picture : data["calibration"]["pictures"]) {
    EXPECT_EQ(picture["corners"].size(), 4U * 54U);
    EXPECT_GT(picture["image"].get<std::string>().size(), 1000U);
  }
  EXPECT_EQ(Json(data["calibration"]["intrinsics"]), result["intrinsics"]);
  std::size_t corners = 0;
  for (const auto& cell : result["residual_map"]["cells"]) {
    corners += cell["corners"].get<std::size_t>();
  }
  EXPECT_EQ(corners, 13U * 54U);
  // 702 corners, each in one ring, and the rings' squares add up to the rms of all.
  double square = 0.0;
  for (const Json& ring : result["growth"]) {
    if (ring["corners"].get<int>() > 0) {
      square += ring["corners"].get<double>() * std::pow(ring["rms_px"].get<double>(), 2);
    }
  }
  EXPECT_NEAR(std::sqrt(square / 702.0), result["rms_px"].get<double>(), 1e-6);
}

TEST_F(CalibrateOutput, CornersFileHoldsAllThatTheResultNeeds) {
  const Json result = calibrated_left();
  const std::vector<CsvRow> rows = parse_csv(read_file(folder_ / "out/corners.csv"), "corners.csv");
  ASSERT_EQ(rows.size(), 1U + 702U);
  double square = 0.0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    square += std::pow(*rows[i][7].number(), 2) + std::pow(*rows[i][8].number(), 2);
  }
  EXPECT_NEAR(std::sqrt(square / 702.0), result["rms_px"].get<double>(), 1e-6);
  // Residuals below 0 are no formulas for spreadsheets.
  EXPECT_EQ(read_file(folder_ / "out/corners.csv").find('\''), std::string::npos);

  const Json again =
      result_of({"calibrate", "--from", "out/corners.csv", "--board", board_, "--out", "again"});
  for (const char* key : {"pictures", "intrinsics", "rms_px", "prediction_rms_px", "covariance"}) {
    EXPECT_EQ(again[key], result[key]) << key;
  }
  EXPECT_EQ(read_file(folder_ / "again/corners.csv"), read_file(folder_ / "out/corners.csv"));
}

TEST_F(CalibrateOutput, CornersOfARobotsPicturesGiveTheSameHandEye) {
  if (franka().result.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  const fs::path set = photographs("field/handeye_franka");
  fs::copy(franka().folder / "out", folder_ / "out");
  Arguments from = {"calibrate", "--from", "out/corners.csv", "--out", "again"};
  from.insert(from.end(), {"--board", "out/board.toml"});
  from.insert(from.end(), {"--camera", (set / "franka_camera.xml").string(), "--poses"});
  from = with(with(from, files_in(set, "franka_pose_rPe_", ".yaml")), kOneSplit);
  const Json again = result_of(from);
  EXPECT_EQ(again["hand_eye"], franka().result["hand_eye"]);
  EXPECT_EQ(again["pictures"], franka().result["pictures"]);
}

/// Numbers to what the solver's last step leaves open, everything else alike.
void expect_near(const Json& found, const Json& wanted, const std::string& where) {
  ASSERT_EQ(found.is_number(), wanted.is_number()) << where;
  if (wanted.is_number()) {
    const double value = wanted.get<double>();
    EXPECT_NEAR(found.get<double>(), value, 5e-4 * std::max(1.0, std::abs(value))) << where;
  } else if (wanted.is_structured()) {
    ASSERT_EQ(found.size(), wanted.size()) << where;
    for (const auto& [key, value] : wanted.items()) {
      const bool is_list = wanted.is_array();
      expect_near(is_list ? found[static_cast<std::size_t>(std::stoi(key))] : found.at(key),
                  value,
                  where + "." + key);
    }
  } else {
    EXPECT_EQ(found, wanted) << where;
  }
}

/// What is told of guesses, and where files are, may differ.
void expect_same_calibration(Json again, Json result) {
  for (const char* key : {"notes", "report", "folder"}) {
    again.erase(key);
    result.erase(key);
  }
  expect_near(again, result, "");
}

TEST_F(CalibrateOutput, TheFolderOfACalibrationAloneGivesItAgain) {
  if (franka().result.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  // With a known camera and poses in metres, one a file.
  const std::string arm = (franka().folder / "out").string();
  expect_same_calibration(result_of(with({"calibrate", "--from", arm, "--out", "arm"}, kOneSplit)),
                          franka().result);

  // With a tool's tip that is taken off the poses.
  Arguments tool = {"calibrate", "--from", arm, "--out", "out"};
  tool.insert(tool.end(), {"--set", "convention.flange_from_tcp=[1, 2, 30, 0.1, 0, 0.2]"});
  tool.emplace_back("--poses");
  tool = with(tool, files_in(photographs("field/handeye_franka"), "franka_pose_rPe_", ".yaml"));
  const Json result = result_of(with(tool, kOneSplit));
  EXPECT_NE(result["hand_eye"], franka().result["hand_eye"]);
  const std::string poses = read_file(folder_ / "out/poses.toml");
  EXPECT_THAT(poses, HasSubstr("flange_from_tcp = [1, 2, 30, 0.1, 0, 0.2]: removed"));
  EXPECT_THAT(poses, HasSubstr("name = \"franka_pose_rPe_4\""));
  expect_same_calibration(
      result_of(with({"calibrate", "--from", "out", "--out", "again"}, kOneSplit)), result);

  fs::remove(folder_ / "out/poses.toml");
  const ProgramResult refused = glint_in(folder_, {"calibrate", "--from", "out", "--out", "third"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--from out: has no poses.toml"));
}

TEST_F(CalibrateOutput, CheckTellsWhetherACalibrationStillHolds) {
  calibrated("left0");
  Arguments check = {"calibrate", "--check", "out"};
  const Arguments fresh = files_in(left_, "left1", ".jpg");
  check.insert(check.end(), fresh.begin(), fresh.end());
  const Json valid = result_of(check);
  EXPECT_EQ(valid["status"], "valid");
  EXPECT_EQ(valid["by"], "reprojection");
  EXPECT_LT(valid["rms_px"].get<double>(), valid["limit_px"].get<double>());
  EXPECT_EQ(valid["pictures"].size(), 4U);

  // The lens was turned: another k1.
  Json calibration = Json::parse(read_file(folder_ / "out/calibration.json"));
  calibration["intrinsics"]["radial"][0] =
      calibration["intrinsics"]["radial"][0].get<double>() + 0.06;
  write_file(folder_ / "out/calibration.json", calibration.dump());
  const Json drifted = result_of(check, 1);
  EXPECT_EQ(drifted["status"], "drifted");
  EXPECT_GT(drifted["drift_px"].get<double>(), 0.1);
}

TEST_F(CalibrateOutput, CheckByPosesFindsACameraThatWasMoved) {
  const fs::path set = photographs("calibration/board_on_robot");
  const Arguments pictures = files_in(set, "img0", ".png");
  const std::string poses = (set / "poses.csv").string();
  fs::copy(board_on_robot().folder / "out", folder_ / "out");
  // img02 is wrong in the set itself.
  std::string chosen = read_file(poses);
  chosen = std::regex_replace(chosen, std::regex("[^\n]*(img1|img02)[^\n]*\n"), "");
  write_file(folder_ / "chosen.csv", chosen);
  Arguments check = {"calibrate"};
  for (const std::string& picture : pictures) {
    if (picture.find("img02") == std::string::npos) {
      check.push_back(picture);
    }
  }
  check.insert(check.end(), {"--check", "out/calibration.json", "--poses", "chosen.csv"});
  const Json valid = result_of(check);
  EXPECT_EQ(valid["status"], "valid") << valid;
  EXPECT_EQ(valid["by"], "prediction");

  // A file whose mark no picture showed, and whose squares were measured, is the same board.
  Json calibration = Json::parse(read_file(folder_ / "out/calibration.json"));
  calibration["board"]["given_mark"] = true;
  calibration["board"]["given_square_mm"] = 10.03;
  write_file(folder_ / "out/calibration.json", calibration.dump());
  write_file(folder_ / "mark.toml",
             "[board]\ncols = 9\nrows = 7\nsquare_mm = 10.03\nmark = true\n");
  Arguments by_file = check;
  by_file.insert(by_file.end(), {"--board", "mark.toml"});
  const Json same = result_of(by_file);
  EXPECT_EQ(same["rms_px"], valid["rms_px"]);
  EXPECT_THAT(same["notes"].dump(), Not(HasSubstr("show the mark")));

  // What the poses predict is compared with nothing where it is not known.
  Json unknown = calibration;
  unknown["prediction_rms_px"] = nullptr;
  write_file(folder_ / "out/calibration.json", unknown.dump());
  const Json open = result_of(check, 1);
  EXPECT_EQ(open["status"], "not_judged");
  EXPECT_EQ(open["expected_px"], nullptr);
  EXPECT_EQ(open["rms_px"], valid["rms_px"]);
  EXPECT_THAT(open["notes"].dump(), HasSubstr("prediction_rms_px is null"));

  Json& place = calibration["hand_eye"]["translation_mm"];
  place[0] = place[0].get<double>() + 20.0;
  calibration["convention"]["flange_from_tcp"] = {0, 0, 100, 0, 0, 0};
  write_file(folder_ / "out/calibration.json", calibration.dump());
  const Json drifted = result_of(check, 1);
  EXPECT_EQ(drifted["status"], "drifted");
  EXPECT_THAT(drifted["notes"].dump(), HasSubstr("convention.flange_from_tcp=[0.0, 0.0, 100.0"));
  EXPECT_GT(std::hypot(drifted["mean_px"][0].get<double>(), drifted["mean_px"][1].get<double>()),
            2.0);
}

TEST_F(CalibrateOutput, UndistortWritesStraightPicturesOfTheSameDepthAndTheirCamera) {
  calibrated_left();
  write_png(folder_ / "deep.png", ImageF(640, 480, 0.31F), PixelDepth::k16Bit);
  write_exr(folder_ / "float.exr", ImageF(640, 480, 1.7F));
  const Json result = result_of({"undistort",
                                 (left_ / "left01.jpg").string(),
                                 "deep.png",
                                 "float.exr",
                                 "--camera",
                                 "out/calibration.toml",
                                 "--out",
                                 "straight"});
  EXPECT_EQ(result["pictures"][0]["written"], "left01.png");
  EXPECT_EQ(read_picture(folder_ / "straight/left01.png").bits, 8);
  EXPECT_EQ(read_picture(folder_ / "straight/deep.png").bits, 16);
  EXPECT_TRUE(read_picture(folder_ / "straight/float.exr").is_float);
  EXPECT_NEAR(read_image(folder_ / "straight/deep.png")(320, 240), 0.31F, 1e-5F);

  // The board in the straight picture fits a camera without distortion.
  Arguments straighten = {"undistort", "--camera", "out/calibration.toml", "--out", "all"};
  const Arguments pictures = files_in(left_, "left", ".jpg");
  straighten.insert(straighten.end(), pictures.begin(), pictures.end());
  result_of(straighten);
  Arguments again = {
      "calibrate", "--board", board_, "--camera", "all/camera.toml", "--out", "fixed"};
  const Arguments straight = files_in(folder_ / "all", "left", ".png");
  again.insert(again.end(), straight.begin(), straight.end());
  const Json fixed = result_of(again);
  EXPECT_LT(fixed["rms_px"].get<double>(), 0.35);
  EXPECT_EQ(fixed["intrinsics"]["radial"], Json({0.0, 0.0, 0.0}));
}

TEST_F(CalibrateOutput, UndistortKeepsColour) {
  write_file(folder_ / "camera.toml",
             "[camera]\nwidth_px = 64\nheight_px = 48\nfocal_x_px = 90\nk1 = -0.1\n");
  const std::vector<ImageF> colours = {
      ImageF(64, 48, 0.8F), ImageF(64, 48, 0.4F), ImageF(64, 48, 0.2F)};
  write_png(folder_ / "eight.png", rgb_of(colours));
  write_tiff(folder_ / "sixteen.tiff", colours);
  write_exr_channels(folder_ / "float.exr",
                     64,
                     48,
                     std::array{exr_channel("R", colours[0]),
                                exr_channel("G", colours[1]),
                                exr_channel("B", colours[2])});
  const Json result = result_of({"undistort",
                                 "eight.png",
                                 "sixteen.tiff",
                                 "float.exr",
                                 "--camera",
                                 "camera.toml",
                                 "--out",
                                 "straight"});
  const std::array<int, 3> bits = {8, 16, 32};
  for (std::size_t i = 0; i < 3; ++i) {
    const fs::path file =
        folder_ / "straight" / result["pictures"][i]["written"].get<std::string>();
    const Picture picture = read_picture(file);
    EXPECT_EQ(picture.channels, 3) << file;
    EXPECT_EQ(picture.bits, bits[i]) << file;
    const std::vector<ImageF> straight = read_colours(file);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(straight[k](32, 24), colours[k](32, 24), i == 0 ? 2e-3 : 2e-5) << file;
    }
  }
}

TEST_F(CalibrateOutput, UndistortRefusesWhatDoesNotGoTogether) {
  write_png(folder_ / "a.png", ImageF(64, 48, 0.5F), PixelDepth::k8Bit);
  write_file(folder_ / "camera.toml", "[camera]\nwidth_px = 65\nheight_px = 48\nfocal_x_px = 90\n");
  fs::create_directories(folder_ / "b");
  write_png(folder_ / "b/a.png", ImageF(64, 48, 0.5F), PixelDepth::k8Bit);
  const auto refused = [&](Arguments arguments, const std::string& message, int code = 2) {
    arguments.insert(arguments.begin(), "undistort");
    arguments.insert(arguments.end(), {"--out", "out"});
    const ProgramResult result = glint_in(folder_, arguments);
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  };
  refused({"--camera", "camera.toml"}, "PICTURES: there are none");
  refused({"a.png"}, "--camera: is missing");
  refused({"a.png", "--camera", "camera.toml"},
          "a.png: has 64 x 48 pixels, the camera of camera.toml");
  refused({"a.png", "b/a.png", "--camera", "camera.toml"}, "b/a.png: another picture of that name");
  refused({"none.png", "--camera", "camera.toml"}, "none.png", 3);
}

TEST_F(CalibrateOutput, PlanGivesPosesThatThePosesReaderTakes) {
  calibrated_left();
  const Json plan = result_of({"calibrate",
                               "--plan",
                               "8",
                               "--board",
                               board_,
                               "--camera",
                               "out/calibration.toml",
                               "--out",
                               "plan"});
  EXPECT_EQ(plan["pose"], "board_from_camera");
  EXPECT_EQ(plan["poses"].size(), 8U);
  for (const Json& pose : plan["poses"]) {
    EXPECT_LE(pose["tilt_deg"].get<double>(), 30.5);
  }
  const Json strided = result_of({"calibrate",
                                  "--plan",
                                  "8",
                                  "--camera",
                                  "out",
                                  "--set",
                                  "plan.method=strided",
                                  "--out",
                                  "strided"});
  EXPECT_NE(strided["poses"], plan["poses"]);
}

TEST_F(CalibrateOutput, PlanStaysWhereTheLensIsSharp) {
  write_file(folder_ / "rough.toml",
             "[camera]\nwidth_px = 640\nheight_px = 480\npixel_um = 5\nfocal_mm = 8\n"
             "object_pixel_mm = 0\n[lens]\nfocus_mm = 600\nf_number = 4\n");
  write_file(folder_ / "board.toml", "[board]\ncols = 9\nrows = 6\nsquare_mm = 8\n");
  const auto planned = [&](const Arguments& more) {
    Arguments all = {"calibrate", "--plan", "6", "--board", "board.toml", "--camera", "rough.toml"};
    all.insert(all.end(), more.begin(), more.end());
    return result_of(all);
  };
  // 2.0 mm of pupil, 8.108 mm of image distance: sharp where |1/600 - 1/z| is below 3.08e-4.
  const Json sharp = planned({"--out", "sharp"});
  EXPECT_NEAR(sharp["near_mm"].get<double>(), 506.0, 1.0);
  EXPECT_THAT(sharp["notes"].dump(), HasSubstr("sharp to one pixel from 506"));
  const Json said =
      planned({"--out", "said", "--set", "plan.near_mm=450", "--set", "plan.far_mm=700"});
  EXPECT_EQ(said["near_mm"], 450.0);
  EXPECT_EQ(said["far_mm"], 700.0);
  EXPECT_EQ(said["notes"], Json::array());
}

TEST_F(CalibrateOutput, APlanOfTwoPosesPromisesNoHandEye) {
  write_file(folder_ / "rough.toml",
             "[camera]\nwidth_px = 800\nheight_px = 600\nfocal_x_px = 900\n");
  write_file(folder_ / "board.toml", "[board]\ncols = 9\nrows = 6\nsquare_mm = 8\n");
  const auto told = [&](const std::string& count) {
    return glint_in(
               folder_,
               {"calibrate", "--plan", count, "--board", "board.toml", "--camera", "rough.toml"})
        .out;
  };
  EXPECT_THAT(told("2"), HasSubstr("no hand-eye: it needs at least 3 poses"));
  EXPECT_THAT(told("4"), HasSubstr("a hand-eye to 0."));
}

TEST_F(CalibrateOutput, PlanForARobotIsInItsBaseAndPointsFallWhereTheBoardIs) {
  const fs::path set = photographs("calibration/board_on_robot");
  const Arguments pictures = files_in(set, "img", ".png");
  const Json& result = board_on_robot().result;
  fs::copy(board_on_robot().folder / "out", folder_ / "out");
  const Json plan = result_of({"calibrate", "--plan", "5", "--camera", "out", "--out", "plan"});
  EXPECT_EQ(plan["pose"], "base_from_flange");
  EXPECT_THAT(read_file(folder_ / "plan/poses.toml"),
              HasSubstr("direction = \"base_from_flange\""));

  // A point 500 mm before the camera on its axis is drawn at the principal point, in every picture.
  const Json& eye = result["hand_eye"];
  const auto at = [&](const char* key, std::size_t i) { return eye[key][i].get<double>(); };
  const auto vector = [&](const char* key) {
    return Eigen::Vector3d(at(key, 0), at(key, 1), at(key, 2));
  };
  const Eigen::Vector3d turn = vector("rotation_vector_rad");
  const Eigen::AngleAxisd rotation(turn.norm(), turn.normalized());
  const Eigen::Vector3d axis = rotation * Eigen::Vector3d(0, 0, 500);
  const Eigen::Vector3d point = vector("translation_mm") + axis;
  const Eigen::Vector3d behind = vector("translation_mm") - axis;
  const Eigen::Vector3d left = vector("translation_mm") + rotation * Eigen::Vector3d(-600, 0, 500);
  write_file(folder_ / "points.csv",
             "name,x_mm,y_mm,z_mm\n" + csv_row_of("axis", point.x(), point.y(), point.z()) +
                 csv_row_of("behind", behind.x(), behind.y(), behind.z()) +
                 csv_row_of("left", left.x(), left.y(), left.z()));
  const Json drawn = result_of({"calibrate",
                                pictures[0],
                                pictures[1],
                                "--points",
                                "points.csv",
                                "--camera",
                                "out",
                                "--out",
                                "drawn"});
  ASSERT_EQ(drawn["pictures"].size(), 2U);
  for (const Json& picture : drawn["pictures"]) {
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(picture["points"][0]["pixel_px"][i].get<double>(),
                  result["intrinsics"]["center_px"][i].get<double>(),
                  1e-6);
    }
    EXPECT_EQ(picture["points"][0]["is_in_picture"], true);
    EXPECT_EQ(picture["points"][1]["is_in_picture"], false);
    EXPECT_LT(picture["points"][2]["pixel_px"][0].get<double>(), 0.0);
  }
  // Pixels left of the picture are no formulas for spreadsheets.
  EXPECT_EQ(read_file(folder_ / "drawn/points.csv").find('\''), std::string::npos);
  EXPECT_TRUE(fs::exists(folder_ / "drawn/img00.png"));
}

}  // namespace
}  // namespace glint::test
