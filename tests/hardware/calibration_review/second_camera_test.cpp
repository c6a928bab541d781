// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration_review/second_camera.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "hardware/calibration/camera_calibration.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

/// The last of the seeds to try: a few, or all among the slow tests, whose environment asks for
/// them.
std::uint64_t last_seed(std::uint64_t few, std::uint64_t all) {
  return std::getenv("GLINT_ALL_CELLS") != nullptr ? all : few;
}

/// The bundle of pictures of which some were taken with a longer lens.
Bundle solved_with(SimulatedCell cell, const std::vector<bool>& is_second, double factor) {
  const Eigen::Vector2d center_px(0.5 * kCellWidth, 0.5 * kCellHeight);
  for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
    if (!is_second[i]) {
      continue;
    }
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

/// Those from `first` on.
Bundle solved(const SimulatedCell& cell, std::size_t first, double factor) {
  std::vector<bool> is_second(cell.pictures.size(), false);
  std::fill(is_second.begin() + static_cast<std::ptrdiff_t>(first), is_second.end(), true);
  return solved_with(cell, is_second, factor);
}

// Pictures of a plane tell a longer lens only by their perspective.
TEST(FindSecondCamera, FindsWhereTheLensWasAnother) {
  for (std::uint64_t seed = 1; seed <= last_seed(1, 3); ++seed) {
    const SimulatedCell cell = simulate_cell({.num_poses = 14}, seed);
    for (const double factor : {0.9, 1.1}) {
      const auto second = find_second_camera(solved(cell, 6, factor));
      ASSERT_TRUE(second.has_value());
      EXPECT_EQ(second->first_view, 6U);
      EXPECT_TRUE(second->is_one_after_the_other());
      EXPECT_NEAR(second->focal_ratio, factor, 0.03);
    }
  }
}

/// Every second picture, or those of a random half, by a camera with another lens.
TEST(FindSecondCamera, FindsCamerasThatTookTurns) {
  for (std::uint64_t seed = 4; seed <= last_seed(5, 6); ++seed) {
    SimulatedCell cell = simulate_cell({.num_poses = 16}, seed);
    std::vector<bool> is_second;
    for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
      is_second.push_back(seed == 4U ? i % 2 == 1 : (i * i + seed) % 5 < 2);
    }
    const auto second = find_second_camera(solved_with(cell, is_second, 1.1));
    ASSERT_TRUE(second.has_value()) << seed;
    if (is_second.front()) {
      is_second.flip();
    }
    EXPECT_EQ(second->is_second, is_second) << seed;
    EXPECT_FALSE(second->is_one_after_the_other());
  }
}

// Also where a board is not flat, and neighbouring corners share their errors.
TEST(FindSecondCamera, FindsNoneInPicturesOfOne) {
  for (const double shared_px : {0.0, 0.3}) {
    for (const int num_poses : {9, 14, 30}) {
      for (std::uint64_t seed = 1; seed <= last_seed(2, 10); ++seed) {
        const SimulatedCell cell =
            simulate_cell({.num_poses = num_poses, .shared_px = shared_px}, seed);
        EXPECT_FALSE(find_second_camera(solved(cell, cell.pictures.size(), 1.0))) << seed;
      }
    }
  }
}

// A print that is 0.3 % longer along the board's x, upright in half of the pictures and turned by a
// quarter in the others: one camera.
TEST(FindSecondCamera, FindsNoneInPicturesOfAStretchedBoard) {
  for (std::uint64_t seed = 1; seed <= last_seed(2, 5); ++seed) {
    SimulatedCell cell = simulate_cell({.num_poses = 16}, seed);
    for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
      for (Eigen::Vector3d& corner_mm : cell.pictures[i].board_mm) {
        if (i % 2 == 1) {
          corner_mm = {-corner_mm.y(), corner_mm.x(), 0.0};
        }
        corner_mm.x() /= 1.003;
      }
    }
    EXPECT_FALSE(find_second_camera(solved(cell, cell.pictures.size(), 1.0))) << seed;
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
