// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration_review/second_camera.h"

#include <gtest/gtest.h>

#include "hardware/calibration/camera_calibration.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

/// The bundle of pictures of which those from `first` on were taken with a longer lens.
Bundle solved(SimulatedCell cell, std::size_t first, double factor) {
  const Eigen::Vector2d center_px(0.5 * kCellWidth, 0.5 * kCellHeight);
  for (std::size_t i = first; i < cell.pictures.size(); ++i) {
    for (Eigen::Vector2d& corner_px : cell.pictures[i].picture_px) {
      corner_px = center_px + factor * (corner_px - center_px);
    }
  }
  CameraOptions options;
  options.width_px = kCellWidth;
  options.height_px = kCellHeight;
  const CameraCalibration result = calibrate_camera(cell.pictures, options);
  EXPECT_TRUE(result.succeeded) << result.refusal;
  EXPECT_EQ(result.bundle.views.size(), cell.pictures.size());
  return result.bundle;
}

// Pictures of a plane tell a longer lens only by their perspective.
TEST(FindSecondCamera, FindsWhereTheLensWasAnother) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const SimulatedCell cell = simulate_cell({.num_poses = 14}, seed);
    for (const double factor : {0.9, 1.1}) {
      const auto second = find_second_camera(solved(cell, 6, factor));
      ASSERT_TRUE(second.has_value());
      EXPECT_EQ(second->first_view, 6U);
      EXPECT_NEAR(second->focal_ratio, factor, 0.03);
    }
  }
}

// Also where a board is not flat, and neighbouring corners share their errors.
TEST(FindSecondCamera, FindsNoneInPicturesOfOne) {
  for (const double shared_px : {0.0, 0.3}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const SimulatedCell cell = simulate_cell({.num_poses = 9, .shared_px = shared_px}, seed);
      EXPECT_FALSE(find_second_camera(solved(cell, 9, 1.0)).has_value()) << seed;
    }
  }
}

TEST(FindSecondCamera, NeedsFourViewsOfEach) {
  const SimulatedCell cell = simulate_cell({.num_poses = 12}, 1);
  Bundle bundle = solved(cell, 6, 1.1);
  bundle.views.resize(7);
  EXPECT_FALSE(find_second_camera(bundle).has_value());
}

}  // namespace
}  // namespace glint
