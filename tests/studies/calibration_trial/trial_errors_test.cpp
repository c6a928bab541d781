// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibration_trial/trial_errors.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/pose_keys.h"
#include "core/units.h"
#include "tests/studies/calibration_trial/camera_on_robot.h"

namespace glint {
namespace {

std::vector<RigidTransform> some_poses(const CameraOnRobot& truth) {
  std::vector<RigidTransform> poses;
  for (std::uint64_t i = 0; i < 5; ++i) {
    poses.push_back(draw_pose(truth, test::kBoard, {}, i).told);
  }
  return poses;
}

TEST(TrialErrors, OfTheTruthAreNone) {
  const CameraOnRobot truth = test::camera_on_robot();
  const TrialErrors errors = trial_errors(truth, truth, some_poses(truth));
  EXPECT_LT(errors.rotation_rad, 1e-7);
  EXPECT_EQ(errors.translation_mm, 0.0);
  EXPECT_LT(errors.overlap.rms_px, 1e-8);
  EXPECT_TRUE(errors.is_board_upright);
}

// A principal point that is off by (0.6, 0.8) moves every point by 1 px.
TEST(TrialErrors, AWrongPrincipalPointShowsEverywhere) {
  const CameraOnRobot truth = test::camera_on_robot();
  CameraOnRobot estimate = truth;
  estimate.intrinsics.center_px += Eigen::Vector2d(0.6, 0.8);
  const TrialErrors errors = trial_errors(truth, estimate, some_poses(truth));
  EXPECT_NEAR(errors.overlap.rms_px, 1.0, 1e-9);
  EXPECT_NEAR(errors.overlap.center_px, 1.0, 1e-9);
  EXPECT_NEAR(errors.overlap.edge_px, 1.0, 1e-9);
}

// A focal length of 1 % too much moves a point 0.4 widths (490 px) and more from the middle by at
// least 4 px, one within a sixth (204 px) by at most 2.1 and the distance of the principal point.
TEST(TrialErrors, AWrongFocalLengthGrowsTowardsTheEdge) {
  const CameraOnRobot truth = test::camera_on_robot();
  CameraOnRobot estimate = truth;
  estimate.intrinsics.focal_px *= 1.01;
  const OverlapError overlap = trial_errors(truth, estimate, some_poses(truth)).overlap;
  EXPECT_GT(overlap.edge_px, 4.5);
  EXPECT_LT(overlap.center_px, 2.1);
}

// 3, 4 and 12 mm are 13 mm apart; the camera is turned by 0.01 rad.
TEST(TrialErrors, OfTheHandEyeAreADistanceAndAnAngle) {
  const CameraOnRobot truth = test::camera_on_robot();
  CameraOnRobot estimate = truth;
  estimate.hand_eye = truth.hand_eye * transform_of({.translation_mm = {3.0, 4.0, 12.0},
                                                     .rotation_vector_rad = {0.0, 0.01, 0.0}});
  const TrialErrors errors = trial_errors(truth, estimate, some_poses(truth));
  EXPECT_NEAR(errors.translation_mm, 13.0, 1e-9);
  EXPECT_NEAR(errors.rotation_rad, 0.01, 1e-9);
  EXPECT_EQ(trial_goals(errors)[1].found, errors.translation_mm);
  EXPECT_NEAR(trial_goals(errors)[0].found, 0.01 * kDegPerRad, 1e-7);
}

TEST(TrialErrors, ABoardTurnedRoundIsTold) {
  const CameraOnRobot truth = test::camera_on_robot();
  CameraOnRobot estimate = truth;
  estimate.board = truth.board * transform_of({.rotation_vector_rad = {0.0, 0.0, kPi}});
  EXPECT_FALSE(trial_errors(truth, estimate, some_poses(truth)).is_board_upright);
}

TEST(EstimateOf, ReadsACalibration) {
  const auto json = nlohmann::ordered_json::parse(R"({
    "setup": "eye_to_hand",
    "intrinsics": {"focal_px": [1, 2], "center_px": [3, 4], "radial": [5, 6, 7],
                   "tangential": [8, 9], "width_px": 10, "height_px": 11},
    "hand_eye": {"rotation_vector_rad": [0, 0, 0], "translation_mm": [1, 2, 3]},
    "board": {"pose": {"rotation_vector_rad": [0, 0, 0], "translation_mm": [4, 5, 6]}}})");
  const CameraOnRobot estimate = estimate_of(json);
  EXPECT_EQ(estimate.setup, CalibrationSetup::kEyeToHand);
  EXPECT_EQ(estimate.intrinsics.focal_px, Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(estimate.intrinsics.tangential[1], 9.0);
  EXPECT_EQ(estimate.hand_eye.translation_mm.z(), 3.0);
  EXPECT_EQ(estimate.board.translation_mm.x(), 4.0);
}

}  // namespace
}  // namespace glint
