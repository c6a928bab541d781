// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rounds that have ended are not driven, and what their pictures tell is given: tests of the whole
// program calibrate (cli/acquire/calibrate_cell_test.cpp). The board lies so far from the arm that
// no further pose is reached.
#include "studies/calibrate_cell/calibrate_cell_run.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/acquire/acquired.h"
#include "studies/calibrate/calibrate_run.h"
#include "studies/cell/typed_permit.h"
#include "tests/studies/cell/ur3_cells.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr int kPictures = 10;
constexpr int kPosesARound = 3;
constexpr double kSquare_mm = 4.0;
constexpr const char* kSmallBoard = "[board]\ncols = 9\nrows = 6\nsquare_mm = 4\n";

/// A camera of 480 x 360 pixels beside the flange over that board, whose p1 and p2 were left at 0.
constexpr const char* kKnownCell = R"({
  "intrinsics": {"width_px": 480, "height_px": 360, "focal_px": [500, 500],
                 "center_px": [240, 180], "radial": [0, 0, 0], "tangential": [0, 0],
                 "free": ["fx", "fy", "cx", "cy"]},
  "board": {"kind": "checkerboard", "cols": 9, "rows": 6, "square_mm": 4, "mark": false,
            "pose": {"rotation_vector_rad": [0, 0, 0], "translation_mm": [1500, 0, 0]}},
  "hand_eye": {"to": "flange", "rotation_vector_rad": [0, 0, 0], "translation_mm": [0, 50, 30],
               "sigma_mm": 0.1, "sigma_deg": 0.05},
  "noise": {"corner_px": 0.05, "robot_deg": 0.006, "robot_mm": 0.02, "pattern_px": 0.05},
  "point_error_px": {"rms": 0.2},
  "rms_px": 0.07, "prediction_rms_px": 0.3, "covariance": []
})";

constexpr const char* kKnownPlace =
    "[calibration.flange_from_camera]\ntranslation_mm = [0, 50, 30]\n"
    "rotation_vector_deg = [0, 0, 0]\n";

/// Tilted to another side in each picture.
Isometry3d camera_from_small_board(int number) {
  const double about = 2.4 * number;
  const Vector3d side(std::cos(about), std::sin(about), 0.0);
  Isometry3d pose = Isometry3d::Identity();
  pose.translate(Vector3d(3.0 * side.x(), 2.0 * side.y(), 80.0 + 4.0 * (number % 3)));
  pose.rotate(AngleAxisd(number == 0 ? 0.0 : 0.4, side));
  pose.rotate(AngleAxisd(0.35 * (number % 5 - 2), Vector3d::UnitZ()));
  pose.translate(Vector3d(-4.0 * kSquare_mm, -2.5 * kSquare_mm, 0.0));
  return pose;
}

/// Of the flange.
Isometry3d told_pose(int number) {
  const Isometry3d base_from_board(Eigen::Translation3d(1500.0, 0.0, 0.0));
  return base_from_board * camera_from_small_board(number).inverse() *
         Eigen::Translation3d(0.0, -50.0, -30.0);
}

/// What the first round's pictures tell, and others do not show the board.
Json known_calibration(const CalibrateOptions& options) {
  Json json = Json::parse(kKnownCell);
  for (std::size_t i = 0; i < options.pictures.size(); ++i) {
    json["pictures"].push_back({{"accepted", i < kPictures}});
  }
  make_folder(options.out);
  write_file(options.out / "calibration.json", json.dump());
  write_file(options.out / "calibration.toml", kKnownPlace);
  return json;
}

class CellRounds : public testing::Test {
 protected:
  CellRounds() {
    write_file(folder_ / "board.toml", kSmallBoard);
    std::string cell = test::kUr3Cell;
    for (int view = 0; view < 3; ++view) {
      cell += fmt::format("[[view]]\njoints_deg = [{}, -95, 95, -85, -90, 0]\n", 5 * view);
    }
    write_file(folder_ / "cell.toml",
               cell + "[camera]\naddress = \"127.0.0.1\"\nregion_px = [0, 0, 480, 360]\n");
    Json pictures;
    for (int i = 0; i < kPictures; ++i) {
      pictures.push_back(kept(1, i));
    }
    end_round(1, pictures);
  }

  /// A round whose only picture does not show the board: what is known stays as it is.
  void end_blank_round() const { end_round(2, Json::array({kept(2, 0)})); }

  Json calibrated(const calibrate_cell_detail::RoundTargets& targets,
                  int poses_a_round = kPosesARound) const {
    const CalibrateCellOptions options = {
        .acquire = {.cell = folder_ / "cell.toml", .out = folder_ / "out"},
        .board = folder_ / "board.toml",
        .targets = targets,
        .poses_a_round = poses_a_round,
        .calibrate = known_calibration};
    return calibrate_cell(options, typed_permit(true, "calibrate --cell"));
  }

  Json plan(int round) const {
    return Json::parse(read_file(folder_ / fmt::format("out/plan_{}/plan.json", round)));
  }

 private:
  std::filesystem::path round_folder(int round) const {
    return folder_ / fmt::format("out/round_{}", round);
  }

  Json kept(int round, int number) const {
    const std::string file = fmt::format("{}.png", number);
    make_folder(round_folder(round));
    write_file(round_folder(round) / file, "a picture");
    return picture_json({.view = fmt::format("board_{}", number),
                         .file = file,
                         .base_from_flange = told_pose(number)});
  }

  void end_round(int round, const Json& pictures) const {
    const Json acquired = {{"kind", "acquired"},
                           {"status", "complete"},
                           {"counts", {{"wanted", pictures.size()}, {"accepted", pictures.size()}}},
                           {"pictures", pictures}};
    write_file(round_folder(round) / "acquired.json", acquired.dump());
  }

  TemporaryFolder folder_;
};

// Without what the plan promises it would end as the second round has not helped.
TEST_F(CellRounds, GoOnWhereAPlanForTheHandEyePromisesMore) {
  end_blank_round();
  const auto told = calibrated({.hand_eye_mm = 1e-6});
  EXPECT_EQ(told["status"], "no_pose_reached") << told;
  EXPECT_EQ(told["rounds"].size(), 2U);
  const auto third = plan(3);
  ASSERT_TRUE(third.contains("after")) << third;
  ASSERT_EQ(third["after"].size(), 3U * kPosesARound);
  EXPECT_LT(third["after"][kPosesARound - 1]["hand_eye_mm"], third["before"]["hand_eye_mm"]);
}

// Both calls plan the second round, which no picture has been taken of.
TEST_F(CellRounds, PlanForWhatMissesItsTargetByMostNow) {
  EXPECT_EQ(calibrated({.hand_eye_mm = 1e-6})["status"], "no_pose_reached");
  const auto for_hand_eye = plan(2);
  EXPECT_EQ(calibrated({.point_px = 1e-6, .hand_eye_mm = 1000.0})["status"], "no_pose_reached");
  const auto for_all = plan(2);
  EXPECT_TRUE(for_all.contains("after")) << "it adds to the pictures";
  EXPECT_NE(for_all["poses"], for_hand_eye["poses"]);
}

// 900 poses are more than a plan tries.
TEST_F(CellRounds, EndWithTheirResultWhereNoPlanCanBeMade) {
  end_blank_round();
  const auto told = calibrated({.hand_eye_mm = 1e-6}, 300);
  EXPECT_EQ(told["status"], "no_pose_helps") << told;
}

}  // namespace
}  // namespace glint
