// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/plan_run.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "core/file.h"
#include "tests/studies/calibrate/calibrate_fixture.h"

namespace glint::test {
namespace {

/// A narrow camera that is the flange, above a board at the base; p1 and p2 were left at 0.
constexpr const char* kCalibration = R"({
  "intrinsics": {"width_px": 1224, "height_px": 1025, "focal_px": [3600, 3600],
                 "center_px": [612, 512], "radial": [0, 0, 0], "tangential": [0, 0],
                 "free": ["fx", "fy", "cx", "cy"]},
  "board": {"kind": "checkerboard", "cols": 10, "rows": 8, "square_mm": 3.3, "mark": true,
            "pose": {"rotation_vector_rad": [0, 0, 0], "translation_mm": [0, 0, 0]}},
  "hand_eye": {"to": "flange", "rotation_vector_rad": [0, 0, 0], "translation_mm": [0, 0, 0]},
  "noise": {"corner_px": 0.06, "robot_deg": 0.004, "robot_mm": 0.01, "pattern_px": 0.06},
  "rms_px": 0.08, "prediction_rms_px": 0.4, "covariance": []
})";

/// The board's middle 180 mm before the camera, tilted to six sides.
std::vector<Eigen::Isometry3d> tilted_poses() {
  const Eigen::Vector3d middle(14.85, 11.55, 0.0);
  std::vector<Eigen::Isometry3d> poses;
  for (int side = 0; side < 6; ++side) {
    const double about = side * std::numbers::pi / 3.0;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(middle);
    pose.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
    pose.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(std::cos(about), std::sin(about), 0.0)));
    pose.translate(Eigen::Vector3d(0.0, 0.0, -180.0));
    poses.push_back(pose);
  }
  return poses;
}

TEST(PlanRun, AddsToPicturesAtTheirDepths) {
  const TemporaryFolder folder;
  write_file(folder / "calibration.json", kCalibration);
  const PosePlanOptions alone = {
      .count = 6, .camera = folder / "calibration.json", .out = folder / "alone"};
  const auto first = plan_poses(alone);
  EXPECT_GT(first["far_mm"].get<double>(), 400.0);
  EXPECT_FALSE(first.contains("after"));
  PosePlanOptions more = alone;
  more.out = folder / "more";
  more.taken = tilted_poses();
  more.aim_deg = 0.012;
  const auto plan = plan_poses(more);
  EXPECT_GT(plan["near_mm"].get<double>(), 150.0);
  EXPECT_LT(plan["far_mm"].get<double>(), 215.0);
  ASSERT_EQ(plan["after"].size(), 6U);
  EXPECT_LT(plan["after"][0]["hand_eye_deg"], plan["before"]["hand_eye_deg"]);
  EXPECT_LT(plan["after"][5]["hand_eye_deg"], plan["after"][0]["hand_eye_deg"]);
}

/// As tilted_poses(), square-on from 40 mm.
std::vector<Eigen::Isometry3d> square_poses() {
  std::vector<Eigen::Isometry3d> poses;
  for (int turn = 0; turn < 6; ++turn) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(Eigen::Vector3d(14.85, 11.55, 0.0));
    pose.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
    pose.rotate(Eigen::AngleAxisd(0.1 * turn, Eigen::Vector3d::UnitZ()));
    pose.translate(Eigen::Vector3d(0.0, 0.0, -40.0));
    poses.push_back(pose);
  }
  return poses;
}

// A tenth of 40 mm is less than a tilt by 20 degrees takes the board's corners.
TEST(PlanRun, TiltsTheBoardBesidePicturesThatAreSquareOn) {
  const TemporaryFolder folder;
  std::string wide = kCalibration;
  wide.replace(wide.find("[3600, 3600]"), 12, "[800, 800]");
  write_file(folder / "calibration.json", wide);
  const auto plan = plan_poses({.count = 6,
                                .camera = folder / "calibration.json",
                                .out = folder / "out",
                                .taken = square_poses(),
                                .aim_deg = 0.012});
  double most_deg = 0.0;
  for (const auto& pose : plan["poses"]) {
    most_deg = std::max(most_deg, pose["tilt_deg"].get<double>());
  }
  EXPECT_GT(most_deg, 19.0) << plan["poses"];
}

// From 2 m on the board of 41 mm fills less than 40 % of the picture, and nothing says how far.
TEST(PlanRun, OneDistanceBeyondTheBoardsSizeGivesTheOther) {
  const TemporaryFolder folder;
  write_file(folder / "calibration.json", kCalibration);
  PosePlanOptions options = {.count = 3,
                             .camera = folder / "calibration.json",
                             .out = folder / "out",
                             .sets = {{"plan.near_mm", "2000"}, {"plan.method", "strided"}}};
  const auto plan = plan_poses(options);
  EXPECT_EQ(plan["near_mm"], 2000.0);
  EXPECT_EQ(plan["far_mm"], 3000.0);
  EXPECT_EQ(plan["poses"].size(), 3U);
  // As near as that it does not fit: the range that was tried is told the right way round.
  options.sets[0] = {"plan.far_mm", "60"};
  EXPECT_THAT([&] { plan_poses(options); },
              ::testing::ThrowsMessage<ConfigError>(
                  ::testing::HasSubstr("show the whole board from 40 to 60 mm")));
}

TEST(PlanRun, ADistanceBeyondWhatTheLensShowsSharpIsRefused) {
  const TemporaryFolder folder;
  write_file(folder / "camera.toml",
             "[camera]\nwidth_px = 1224\nheight_px = 1025\npixel_um = 5\nfocal_mm = 18\n"
             "object_pixel_mm = 0\n[lens]\nfocus_mm = 300\nf_number = 4\n");
  write_file(folder / "board.toml", "[board]\ncols = 10\nrows = 8\nsquare_mm = 3.3\n");
  EXPECT_THAT(
      [&] {
        plan_poses({.count = 3,
                    .board = folder / "board.toml",
                    .camera = folder / "camera.toml",
                    .out = folder / "out",
                    .sets = {{"plan.near_mm", "2000"}}});
      },
      ::testing::ThrowsMessage<ConfigError>(
          ::testing::HasSubstr("plan.near_mm and plan.far_mm: from 2000 to")));
}

}  // namespace
}  // namespace glint::test
