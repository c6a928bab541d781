// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibration_trial/trial_poses.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "core/config/pose_keys.h"
#include "core/error.h"
#include "tests/studies/calibration_trial/camera_on_robot.h"

namespace glint {
namespace {

TEST(CameraOnRobot, PosesOfTheFlangeInvertViewsOfTheBoard) {
  for (const CalibrationSetup setup :
       {CalibrationSetup::kEyeInHand, CalibrationSetup::kEyeToHand}) {
    const CameraOnRobot truth = test::camera_on_robot(setup);
    const RigidTransform view = transform_of(
        {.translation_mm = {-20.0, -15.0, 150.0}, .rotation_vector_rad = {0.2, -0.3, 0.5}});
    const RigidTransform again = camera_from_board(truth, base_from_flange(truth, view));
    EXPECT_LT((again.rotation - view.rotation).norm(), 1e-12);
    EXPECT_LT((again.translation_mm - view.translation_mm).norm(), 1e-9);
  }
}

// Camera 100 mm along the flange's z, the board 500 mm along the base's z: at the flange's pose
// (0, 0, 200) the camera is at 300 and the board 200 mm before it.
TEST(CameraOnRobot, SeesTheBoardOverTheFlange) {
  const CameraOnRobot truth = {.hand_eye = {.translation_mm = {0.0, 0.0, 100.0}},
                               .board = {.translation_mm = {0.0, 0.0, 500.0}}};
  const RigidTransform view = camera_from_board(truth, {.translation_mm = {0.0, 0.0, 200.0}});
  EXPECT_EQ(view.translation_mm, Eigen::Vector3d(0.0, 0.0, 200.0));
}

TEST(DrawPose, ShowsTheWholeBoardWithinItsLimits) {
  const CameraOnRobot truth = test::camera_on_robot();
  const CalibrationTrialSettings settings = {.distance_mm = {140.0, 150.0}};
  const PinholeCamera camera(truth.intrinsics);
  for (std::uint64_t i = 0; i < 200; ++i) {
    const TrialPose pose = draw_pose(truth, test::kBoard, settings, i);
    const RigidTransform view = camera_from_board(truth, pose.told);
    for (const Eigen::Vector3d& corner : corners_mm(test::kBoard)) {
      const auto at = camera.project(view * corner);
      ASSERT_TRUE(at && at->x() > 0.0 && at->y() > 0.0 && at->x() < truth.intrinsics.width_px &&
                  at->y() < truth.intrinsics.height_px);
    }
    // Two tilts of 30 degrees each: the normal's cosine is at least cos(30)^2 = 0.75.
    ASSERT_GE(view.rotation(2, 2), 0.75 - 1e-12);
  }
}

TEST(DrawPose, OfAnIndexDependsOnNothingElse) {
  const CameraOnRobot truth = test::camera_on_robot();
  CalibrationTrialSettings settings;
  const TrialPose pose = draw_pose(truth, test::kBoard, settings, 7);
  settings.pictures = 80;
  EXPECT_EQ(draw_pose(truth, test::kBoard, settings, 7).real.rotation, pose.real.rotation);
  EXPECT_NE(draw_pose(truth, test::kBoard, settings, 8).told.rotation, pose.told.rotation);
  settings.seed = 2;
  EXPECT_NE(draw_pose(truth, test::kBoard, settings, 7).told.rotation, pose.told.rotation);
}

// 1000 draws of three axes: the standard deviation of a root mean square is 1 / sqrt(6000) = 1.3 %;
// 5 % is four of them.
TEST(DrawPose, TheRobotIsOffByItsSigmas) {
  const CameraOnRobot truth = test::camera_on_robot();
  const CalibrationTrialSettings settings = {.robot_sigma_mm = 0.2, .robot_sigma_rad = 1e-3};
  double position = 0.0;
  double turn = 0.0;
  constexpr int kDraws = 1000;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const TrialPose pose = draw_pose(truth, test::kBoard, settings, i);
    const RigidTransform error = inverse(pose.told) * pose.real;
    position += error.translation_mm.squaredNorm();
    turn += std::pow(Eigen::AngleAxisd(error.rotation).angle(), 2.0);
  }
  EXPECT_NEAR(std::sqrt(position / (3.0 * kDraws)), 0.2, 0.01);
  EXPECT_NEAR(std::sqrt(turn / (3.0 * kDraws)), 1e-3, 5e-5);
  const CalibrationTrialSettings exact = {.robot_sigma_mm = 0.0, .robot_sigma_rad = 0.0};
  const TrialPose pose = draw_pose(truth, test::kBoard, exact, 3);
  EXPECT_EQ(pose.told.translation_mm, pose.real.translation_mm);
}

TEST(DrawPose, ABoardThatDoesNotFitIsAnError) {
  const CalibrationTrialSettings settings = {.distance_mm = {20.0, 25.0}};
  try {
    draw_pose(test::camera_on_robot(), test::kBoard, settings, 0);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().front().key, "calibration_trial.distance_mm");
  }
}

}  // namespace
}  // namespace glint
