// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/refinement_rule.h"

#include <limits>

#include <gtest/gtest.h>

namespace glint {
namespace {

constexpr double kAllowed_rad = 1e-4;

// 1.5e-3 is above 2^2 times the limit and below 4^2 times.
TEST(PredictedCells, FollowFromAnErrorThatFallsWithTheSquare) {
  EXPECT_EQ(predicted_cells({.is_whole = true, .error_rad = 4e-4}, kAllowed_rad, 16), 2);
  EXPECT_EQ(predicted_cells({.is_whole = true, .error_rad = 1.5e-3}, kAllowed_rad, 16), 4);
  EXPECT_EQ(predicted_cells({.is_whole = true, .error_rad = 2.5e-2}, kAllowed_rad, 16), 16);
}

TEST(PredictedCells, AreEightWhereNoNumberHelpsAndTwoWhereNothingIsKnown) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  EXPECT_EQ(predicted_cells({.is_whole = false, .error_rad = 0.0}, kAllowed_rad, 16), 8);
  EXPECT_EQ(predicted_cells({.is_whole = true, .error_rad = 1.0}, kAllowed_rad, 16), 8);
  EXPECT_EQ(predicted_cells({.is_whole = true, .error_rad = kUnknown}, kAllowed_rad, 16), 2);
}

TEST(NextCells, DoubleWhereCellsAreBentUpToSixteen) {
  const CheckedCells bent = {.has_bent = true};
  EXPECT_EQ(next_cells(bent, 2, 16), 4);
  EXPECT_EQ(next_cells(bent, 8, 16), 16);
  EXPECT_EQ(next_cells(bent, 16, 16), 0);
  EXPECT_EQ(next_cells({}, 2, 16), 0);
}

TEST(NextCells, AreEightOnceWhereCellsAreBroken) {
  const CheckedCells broken = {.has_bent = true, .has_broken = true};
  EXPECT_EQ(next_cells(broken, 2, 16), 8);
  EXPECT_EQ(next_cells(broken, 8, 16), 0);
}

TEST(RefinementRule, KeepsToTheLargestNumberThatIsAllowed) {
  EXPECT_EQ(predicted_cells({.is_whole = true, .error_rad = 2.5e-2}, kAllowed_rad, 4), 4);
  EXPECT_EQ(predicted_cells({.is_whole = false, .error_rad = 0.0}, kAllowed_rad, 4), 4);
  EXPECT_EQ(predicted_cells({.is_whole = true, .error_rad = 1.0}, kAllowed_rad, 4), 4);
  EXPECT_EQ(next_cells({.has_bent = true}, 2, 4), 4);
  EXPECT_EQ(next_cells({.has_bent = true}, 4, 4), 0);
  EXPECT_EQ(next_cells({.has_broken = true}, 2, 4), 4);
  EXPECT_EQ(next_cells({.has_broken = true}, 4, 4), 0);
}

/// 2 x 2 cells of rays that leave a mirror straight up.
struct FourCells {
  RayCache rays;
  RayGrid grid = {.rays = &rays, .columns = 3, .rows = 3};

  FourCells() {
    resize_rays(rays, 9);
    store_missed(0, 9, rays);
    for (std::size_t i = 0; i < 9; ++i) {
      rays.direction_x[i] = 0.0F;
      rays.direction_y[i] = 0.0F;
      rays.direction_z[i] = 1.0F;
      rays.weight[i] = 0.5F;
    }
  }
};

// The middle ray leaves by 2e-4 of what its four corners say.
TEST(IsDescribedByCorners, ComparesEveryRayWithItsCorners) {
  FourCells cell;
  EXPECT_TRUE(is_described_by_corners(cell.grid, kAllowed_rad, 0.5F));
  cell.rays.direction_x[4] = 2e-4F;
  EXPECT_FALSE(is_described_by_corners(cell.grid, kAllowed_rad, 0.5F));
  EXPECT_TRUE(is_described_by_corners(cell.grid, 3e-4, 0.5F));
}

TEST(IsDescribedByCorners, TakesNoStainsForClean) {
  FourCells cell;
  cell.rays.weight[7] = 0.4F;
  EXPECT_FALSE(is_described_by_corners(cell.grid, kAllowed_rad, 0.5F));
}

}  // namespace
}  // namespace glint
