// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration_review/next_views.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "hardware/calibration/joint_fit.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

using testing::HasSubstr;

TEST(NextViews, ErrorNowIsThatOfTheCovariance) {
  const SimulatedCell cell = simulate_cell({.num_poses = 10}, 1);
  const Bundle bundle = bundle_at_truth(cell);
  const ViewAdvice advice = next_views(bundle, cell_board(), kCellWidth, kCellHeight, 0);
  const PointError error = point_error(bundle, shared_covariance(bundle), kCellWidth, kCellHeight);
  // The same points but for the distortion of their rays.
  EXPECT_NEAR(advice.point_error_px / error.rms_px, 1.0, 0.02);
  EXPECT_TRUE(advice.views.empty());
}

/// The bundle with the advised pictures in it has the error that was foretold.
void expect_kept_promise(Mounting mounting) {
  const SimulatedCell cell = simulate_cell({.mounting = mounting, .num_poses = 8}, 2);
  Bundle bundle = bundle_at_truth(cell);
  const ViewAdvice advice = next_views(bundle, cell_board(), kCellWidth, kCellHeight, 2);
  ASSERT_EQ(advice.views.size(), 2u);
  double before = advice.point_error_px;
  for (const NextView& view : advice.views) {
    EXPECT_LT(view.point_error_px, before);
    before = view.point_error_px;
    ASSERT_TRUE(view.base_from_flange.has_value());
    const Eigen::Isometry3d seen = camera_from_board(mounting, cell.poses, *view.base_from_flange);
    EXPECT_TRUE(seen.isApprox(view.camera_from_board, 1e-9));
    BoardCorners corners{.board_mm = cell_board()};
    for (const Eigen::Vector3d& point : corners.board_mm) {
      corners.picture_px.push_back(*project_by_lens(cell.lens, seen * point, nullptr));
      EXPECT_GT(corners.picture_px.back().minCoeff(), 0.0);
      EXPECT_LT(corners.picture_px.back().x(), kCellWidth);
      EXPECT_LT(corners.picture_px.back().y(), kCellHeight);
    }
    bundle.views.push_back(joint_view(corners, *view.base_from_flange));
  }
  // With the covariance of ten pictures, at the robot poses of the eight.
  const PointError error =
      point_error(bundle_at_truth(cell), shared_covariance(bundle), kCellWidth, kCellHeight);
  EXPECT_NEAR(advice.views.back().point_error_px / error.rms_px, 1.0, 0.02);
}

TEST(NextViews, KeepTheirPromise) {
  expect_kept_promise(Mounting::kEyeInHand);
}

TEST(NextViewsBesideTheRobot, KeepTheirPromise) {
  expect_kept_promise(Mounting::kEyeToHand);
}

TEST(NextViews, TiltTheBoardWhereFlatViewsLackIt) {
  const SimulatedCell cell =
      simulate_cell({.num_poses = 6, .tilt_x_deg = 3.0, .tilt_y_deg = 3.0}, 3);
  const Bundle bundle = bundle_at_truth(cell);
  const ViewAdvice advice = next_views(bundle, cell_board(), kCellWidth, kCellHeight, 1);
  ASSERT_EQ(advice.views.size(), 1u);
  EXPECT_NEAR(advice.views[0].tilt_rad, 30.0 * kRadPerDeg, 1e-12);
  EXPECT_LT(advice.views[0].point_error_px, 0.8 * advice.point_error_px);
}

TEST(NextViews, NearSideIsNearest) {
  const SimulatedCell cell = simulate_cell({.num_poses = 6}, 4);
  const ViewAdvice advice =
      next_views(bundle_at_truth(cell), cell_board(), kCellWidth, kCellHeight, 3);
  for (const NextView& view : advice.views) {
    if (view.tilt_rad == 0.0) {
      continue;
    }
    // Of the corners of the board the nearest lies to that side of the middle.
    const Eigen::Vector2d side(std::cos(view.near_side_rad), std::sin(view.near_side_rad));
    const std::vector<Eigen::Vector3d> board = cell_board();
    const Eigen::Vector3d middle = 0.5 * (board.front() + board.back());
    const Eigen::Vector3d best = *std::ranges::min_element(
        board, {}, [&](const Eigen::Vector3d& p) { return (view.camera_from_board * p).z(); });
    const Eigen::Vector3d off = view.camera_from_board.linear() * (best - middle);
    EXPECT_GT(side.dot(off.head<2>()), 0.0);
  }
}

TEST(NextViews, AreTextAPhotographerUnderstands) {
  const NextView view{.tilt_rad = 30.0 * kRadPerDeg,
                      .near_side_rad = 225.0 * kRadPerDeg,
                      .roll_rad = -45.0 * kRadPerDeg,
                      .middle_px = {30.0, 70.0},
                      .distance_mm = 640.0};
  EXPECT_EQ(text_of(view, 100, 100),
            "the board tilted by 30 degrees, its upper left side nearest, turned by -45 degrees in "
            "the picture, its middle at 30 % of the width and 70 % of the height, 640 mm away");
  EXPECT_THAT(text_of({.distance_mm = 5.0}, 10, 10), HasSubstr("seen squarely"));
}

TEST(NextViews, AreNoneWithoutPicturesOrUnknowns) {
  EXPECT_TRUE(next_views({}, cell_board(), 100, 100, 3).views.empty());
}

}  // namespace
}  // namespace glint
