// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/upkeep/drift.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

TEST(DriftLimit, IsTheQuantileOfChiSquare) {
  // Quantiles 0.999 of chi-square with 2, 10 and 40 degrees of freedom: 13.82, 29.59, 73.40.
  EXPECT_NEAR(drift_limit_px(1.0, 2), std::sqrt(13.82 / 2.0), 0.06);
  EXPECT_NEAR(drift_limit_px(1.0, 10), std::sqrt(29.59 / 10.0), 0.01);
  EXPECT_NEAR(drift_limit_px(0.5, 40), 0.5 * std::sqrt(73.40 / 40.0), 0.005);
}

TEST(DriftLimit, IsExceededOnceInAThousandTimes) {
  int over = 0;
  for (std::uint64_t trial = 0; trial < 20000; ++trial) {
    Rng rng(1, Stream::kTest, trial);
    double square = 0.0;
    for (int i = 0; i < 8; ++i) {
      square += std::pow(rng.normal(), 2);
    }
    over += std::sqrt(square / 8.0) > drift_limit_px(1.0, 8) ? 1 : 0;
  }
  EXPECT_GT(over, 5);
  EXPECT_LT(over, 45);
}

TEST(ResidualsAt, FindTheTurnOfABoardThatLooksTheSame) {
  CellSettings settings{.num_poses = 6, .flipped_share = 0.5};
  settings.noise = {.corner_px = 0.01, .robot_rad = 0.0, .robot_mm = 0.0};
  const SimulatedCell cell = simulate_cell(settings, 4);
  BoardSymmetry symmetry{.turns = 2, .center_mm = {0.5 * 9 * 6.6, 0.5 * 7 * 6.6, 0.0}};
  for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
    const Eigen::Isometry3d pose =
        camera_from_board(settings.mounting, cell.poses, cell.true_base_from_flange[i]);
    const auto turned = residuals_at(cell.lens, pose, symmetry, cell.pictures[i]);
    ASSERT_TRUE(turned.has_value());
    EXPECT_LT(rms_of(*turned), 0.05);
    const auto as_found = residuals_at(cell.lens, pose, cell.pictures[i]);
    EXPECT_EQ(rms_of(*as_found) > 10.0, cell.is_flipped[i]);
  }
}

TEST(BoardSeen, IsWhereTheBoardLies) {
  for (const Mounting mounting : {Mounting::kEyeInHand, Mounting::kEyeToHand}) {
    CellSettings settings{.mounting = mounting, .num_poses = 5};
    const SimulatedCell cell = simulate_cell(settings, 2);
    std::vector<PosePair> pairs;
    for (const Eigen::Isometry3d& pose : cell.true_base_from_flange) {
      pairs.push_back({.base_from_flange = pose,
                       .camera_from_board = camera_from_board(mounting, cell.poses, pose)});
    }
    EXPECT_TRUE(board_seen(mounting, cell.poses.hand_eye, pairs).isApprox(cell.poses.board, 1e-9));
  }
}

}  // namespace
}  // namespace glint
