// SPDX-License-Identifier: GPL-3.0-or-later
//
// A whole trial on small pictures: rendered, written, calibrated from the files.
#include "studies/calibration_trial/trial_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

constexpr const char* kBoardToml = "[board]\ncols = 7\nrows = 5\nsquare_mm = 10\nmark = true\n";

std::string small_trial(const std::string& more = "") {
  return R"(schema = 2
[camera]
width_px = 320
height_px = 260
pixel_um = 26
focal_mm = 12
object_pixel_mm = 0
working_distance_mm = 146
p1 = 1e-3
[lighting.ring]
mount = "camera"
inner_radius_mm = 35
outer_radius_mm = 65
radiance = [8]
[render.paths]
samples = 16
max_reflections = 1
[sensor]
full_well_e = 10000
)" + more +
         "[calibration_trial]\nboard = \"board.toml\"\npictures = 8\nrobot_sigma_mm = 0\n"
         "robot_sigma_deg = 0\n";
}

constexpr const char* kOnFlange =
    "[calibration.flange_from_camera]\ntranslation_mm = [12, -58, 84]\n"
    "rotation_vector_deg = [1, -1, 44]\n[cell.base_from_part]\ntranslation_mm = [420, -110, 60]\n";

class CalibrationTrial : public ::testing::Test {
 protected:
  CalibrationTrial() { write_file(folder_ / "board.toml", kBoardToml); }

  Study study_of(const std::string& text) const {
    write_file(folder_ / "s.toml", text);
    return load_study(folder_ / "s.toml", {});
  }

  Json run(const Study& study) const {
    return run_calibration_trial(study,
                                 {.out = folder_ / "out",
                                  .threads = 2,
                                  .sets = {{"prediction.splits", "1"}},
                                  .progress = Progress::Style::kNone});
  }

  std::string error_of(const std::string& text) const {
    try {
      study_of(text);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
};

void expect_found(const Json& result) {
  EXPECT_EQ(result["status"], "done");
  EXPECT_EQ(result["pictures"]["accepted"], 8);
  EXPECT_TRUE(result["is_board_upright"].get<bool>());
  EXPECT_LT(result["hand_eye"]["error_deg"].get<double>(), 0.5);
  EXPECT_LT(result["hand_eye"]["error_mm"].get<double>(), 1.0);
  EXPECT_LT(result["overlap_px"]["rms"].get<double>(), 0.5);
}

TEST_F(CalibrationTrial, FindsACameraOnTheFlangeFromItsFiles) {
  const Study study = study_of(small_trial(kOnFlange));
  const Json result = run(study);
  expect_found(result);
  for (const char* name : {"pictures/picture_0007.png",
                           "poses.csv",
                           "board.toml",
                           "ink.png",
                           "report.html",
                           "calibration/calibration.toml"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
  }
  EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr("Truth and estimate"));
  EXPECT_EQ(Json::parse(read_file(folder_ / "out/result.json"))["hand_eye"], result["hand_eye"]);

  // The page is made again from the folder.
  EXPECT_TRUE(is_calibration_trial(folder_ / "out"));
  EXPECT_FALSE(is_calibration_trial(folder_ / "out/calibration"));
  EXPECT_THAT(calibration_trial_report(folder_ / "out"), HasSubstr("Truth and estimate"));

  // What is missing is made again, to the same bytes; what is there is kept.
  const std::string bytes = read_file(folder_ / "out/result.json");
  fs::remove(folder_ / "out/pictures/picture_0003.png");
  run(study);
  EXPECT_EQ(read_file(folder_ / "out/result.json"), bytes);

  // Another program drew other poses: neither its pictures nor its poses are mixed with these.
  const std::string poses = "picture_0000.png" + read_file(folder_ / "out/poses.csv");
  write_file(folder_ / "out/poses.csv", poses);
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { run(study); }),
              HasSubstr("holds pictures of another study or board"));
  EXPECT_EQ(read_file(folder_ / "out/poses.csv"), poses);

  std::string other = small_trial(kOnFlange);
  other += "seed = 2\n";
  try {
    run(study_of(other));
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("holds pictures of another study or board"));
  }
}

#ifdef GLINT_ALL_TRIALS  // among the slow tests
constexpr const char* kBesideRobot =
    "[calibration.base_from_camera]\ntranslation_mm = [500, 0, 800]\n"
    "rotation_vector_deg = [175, 2, 3]\n[cell.flange_from_part]\ntranslation_mm = [5, 10, 90]\n";

TEST_F(CalibrationTrial, FindsACameraBesideTheRobot) {
  expect_found(run(study_of(small_trial(kBesideRobot))));
}
#endif

TEST_F(CalibrationTrial, CheckLooksAtTwoPicturesAndWritesNothing) {
  const Json sound = check_calibration_trial(study_of(small_trial(kOnFlange)), 2);
  EXPECT_EQ(sound["status"], "sound");
  EXPECT_EQ(sound["pictures"], 8);
  ASSERT_EQ(sound["views"].size(), 2U);
  for (const Json& view : sound["views"]) {
    EXPECT_TRUE(view["accepted"].get<bool>()) << view;
    EXPECT_EQ(view["corners"], 35);
  }
  EXPECT_GT(sound["predicted_cpu_s"].get<double>(), 0.0);
  EXPECT_THAT(trial_check_text(sound), HasSubstr("35 corners found"));
  EXPECT_EQ(folder_.count(), 2);  // s.toml and board.toml

  std::string dark = small_trial(kOnFlange);
  dark.replace(dark.find("radiance = [8]"), 14, "radiance = [0.01]");
  const Json seen = check_calibration_trial(study_of(dark), 2);
  EXPECT_FALSE(seen["views"][0]["accepted"].get<bool>());
  EXPECT_THAT(trial_check_text(seen), HasSubstr("a picture would be rejected"));
}

TEST_F(CalibrationTrial, NeedsThePlacesAndALight) {
  EXPECT_THAT(error_of(small_trial()),
              HasSubstr("calibration_trial: needs [calibration.flange_from_camera]"));
  EXPECT_THAT(error_of(small_trial("[calibration.flange_from_camera]\n")),
              HasSubstr("calibration_trial: needs [cell.base_from_part]"));
  EXPECT_THAT(error_of(small_trial(std::string(kOnFlange) + "[defects.dent]\n")),
              HasSubstr("which has no [defects]"));
  EXPECT_THAT(error_of(small_trial(std::string(kOnFlange) + "[pod]\ngroup = \"dent\"\n")),
              HasSubstr("pod: cannot be combined with [calibration_trial]"));
  EXPECT_THAT(error_of(small_trial(kOnFlange) + "ink = 0.9\n"),
              HasSubstr("calibration_trial.ink: must be less than"));
}

TEST_F(CalibrationTrial, ARefusedOneLeavesNoFolder) {
  try {
    run(study_of(small_trial(kOnFlange) + "distance_mm = 30\n"));
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("calibration_trial.distance_mm: the board of 7 x 5"));
    EXPECT_THAT(error.what(), HasSubstr("s.toml:"));
  }
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace glint
