// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/cell_rule.h"

#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

constexpr int kColumns = 40;
constexpr int kRows = 6;
constexpr double kMaxError_rad = 2e-4;

/// Rays 0.1 mm apart that leave a flat mirror upwards, all on one patch.
struct GridOfRays {
  RayCache rays;
  std::vector<RayPath> path;
  std::vector<std::int32_t> piece;

  GridOfRays() : path(kColumns * kRows, RayPath::kOnce), piece(kColumns * kRows, 3) {
    resize_rays(rays, kColumns * kRows);
    store_missed(0, kColumns * kRows, rays);
    for (int y = 0; y < kRows; ++y) {
      for (int x = 0; x < kColumns; ++x) {
        const std::size_t i = at(x, y);
        rays.origin_x[i] = 0.1F * static_cast<float>(x);
        rays.origin_y[i] = 0.1F * static_cast<float>(y);
        rays.direction_z[i] = 1.0F;
      }
    }
  }

  static std::size_t at(int x, int y) { return static_cast<std::size_t>(y * kColumns + x); }

  RayGrid grid() const {
    return {.rays = &rays,
            .path = path.data(),
            .piece = piece.data(),
            .columns = kColumns,
            .rows = kRows};
  }
};

// The directions turn by 0.4 mrad from column 20 on: a second difference of 0.4 mrad. On a patch a
// linear rule errs by an eighth of it, 0.05 mrad, at a free triangle by up to a half, 0.2 mrad.
TEST(CheckCell, TakesBendsForKinksWhereATriangleIsFree) {
  GridOfRays bent;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 20; x < kColumns; ++x) {
      bent.rays.direction_x[GridOfRays::at(x, y)] = 4e-4F * static_cast<float>(x - 20);
    }
  }
  EXPECT_NEAR(check_cell(bent.grid(), 19, 2).error_rad, 0.5e-4, 1e-8);
  bent.piece[GridOfRays::at(20, 3)] = -1;
  const CellCheck beside = check_cell(bent.grid(), 19, 2);
  EXPECT_TRUE(beside.is_whole);
  EXPECT_NEAR(beside.error_rad, 2e-4, 1e-8);
}

TEST(CheckCell, IsWholeAcrossTheBorderOfFreeTrianglesWhereNothingJumps) {
  GridOfRays border;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 20; x < kColumns; ++x) {
      border.piece[GridOfRays::at(x, y)] = -1;
    }
  }
  EXPECT_TRUE(check_cell(border.grid(), 19, 2).is_whole);
  EXPECT_EQ(check_cell(border.grid(), 19, 2).error_rad, 0.0);
  for (int y = 0; y < kRows; ++y) {  // a step of 0.05 mm: half a cell
    for (int x = 20; x < kColumns; ++x) {
      border.rays.origin_z[GridOfRays::at(x, y)] = 0.05F;
    }
  }
  EXPECT_FALSE(check_cell(border.grid(), 19, 2).is_whole);
  EXPECT_TRUE(check_cell(border.grid(), 18, 2).is_whole) << "a patch beside a step is whole";
}

TEST(CheckCell, IsBrokenBetweenTwoPatchesAlsoByWayOfAFreeTriangle) {
  GridOfRays mixed;
  mixed.piece[GridOfRays::at(10, 2)] = -1;
  EXPECT_TRUE(check_cell(mixed.grid(), 10, 2).is_whole);
  mixed.piece[GridOfRays::at(11, 3)] = 4;
  EXPECT_FALSE(check_cell(mixed.grid(), 10, 2).is_whole);
}

/// Rays that bend, jump, belong to other pieces or took other paths here and there.
GridOfRays random_grid(Rng& rng) {
  GridOfRays grid;
  for (std::size_t i = 0; i < grid.piece.size(); ++i) {
    grid.rays.direction_x[i] += static_cast<float>(rng.uniform(-6e-5, 6e-5));
    grid.rays.origin_z[i] += rng.uniform() < 0.01 ? 0.05F : 0.0F;
    grid.path[i] = rng.uniform() < 0.01 ? RayPath::kFollowed : RayPath::kOnce;
    const double choice = rng.uniform();
    grid.piece[i] = choice < 0.02 ? -1 : choice < 0.03 ? 4 : 3;
  }
  return grid;
}

TEST(MarkSmoothRow, MarksOnlyCellsThatTheRuleFindsSmooth) {
  Rng rng(81, Stream::kTest, 0);
  int marked = 0;
  int smooth = 0;
  for (int round = 0; round < 200; ++round) {
    GridOfRays rays = random_grid(rng);
    if (round % 4 == 0) {
      rays.piece.assign(rays.piece.size(), -1);
    }
    for (int y = 0; y + 1 < kRows; ++y) {
      std::vector<std::uint8_t> is_smooth(kColumns - 1);
      mark_smooth_row(rays.grid(), y, kMaxError_rad, is_smooth.data());
      for (int x = 0; x + 1 < kColumns; ++x) {
        const CellCheck check = check_cell(rays.grid(), x, y);
        const bool is_by_rule = check.is_whole && check.error_rad <= kMaxError_rad;
        const bool is_marked = is_smooth[static_cast<std::size_t>(x)] != 0;
        ASSERT_TRUE(is_by_rule || !is_marked) << x << " " << y;
        marked += is_marked ? 1 : 0;
        smooth += is_by_rule && y > 0 && y + 2 < kRows ? 1 : 0;
      }
    }
  }
  EXPECT_GT(marked, 2000);
  EXPECT_GT(marked, smooth / 4);
}

}  // namespace
}  // namespace glint
