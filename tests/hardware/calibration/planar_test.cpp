// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/planar.h"

#include <vector>

#include <gtest/gtest.h>

#include "hardware/calibration/rotation.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Isometry3d tilted(const Vector3d& turn) {
  Vector6d six;
  six << turn, -20.0, -15.0, 200.0;
  return motion_of(six);
}

BoardCorners seen(const LensVector& lens, const Isometry3d& camera_from_board) {
  BoardCorners corners{.board_mm = cell_board()};
  for (const Vector3d& point : corners.board_mm) {
    corners.picture_px.push_back(*project_by_lens(lens, camera_from_board * point, nullptr));
  }
  return corners;
}

LensVector plain_lens() {
  LensVector lens = LensVector::Zero();
  lens.head<4>() << 1500.0, 1400.0, 620.0, 480.0;
  return lens;
}

TEST(Homography, TakesASquareToItsPicture) {
  // x -> 2 x + 10, y -> 3 y + 20.
  const BoardCorners corners{.board_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                             .picture_px = {{10, 20}, {12, 20}, {10, 23}, {12, 23}}};
  const auto matrix = homography(corners);
  ASSERT_TRUE(matrix.has_value());
  Matrix3d wanted;
  wanted << 2, 0, 10, 0, 3, 20, 0, 0, 1;
  EXPECT_LT((*matrix / (*matrix)(2, 2) - wanted).norm(), 1e-9);
}

TEST(Homography, IsEmptyForCornersOnALineOrTooFew) {
  BoardCorners line;
  for (int i = 0; i < 8; ++i) {
    line.board_mm.emplace_back(i, 2 * i, 0);
    line.picture_px.emplace_back(5 * i, 3 * i);
  }
  EXPECT_FALSE(homography(line).has_value());
  line.board_mm.resize(3);
  line.picture_px.resize(3);
  EXPECT_FALSE(homography(line).has_value());
}

TEST(FocalPx, IsExactFromTwoTiltedViews) {
  std::vector<Matrix3d> matrices;
  for (const Vector3d& turn : {Vector3d(0.4, 0.1, 0.2), Vector3d(-0.2, 0.5, 1.0)}) {
    matrices.push_back(*homography(seen(plain_lens(), tilted(turn))));
  }
  const auto focal = focal_px(matrices, {620.0, 480.0});
  ASSERT_TRUE(focal.has_value());
  EXPECT_LT((*focal - Vector2d(1500.0, 1400.0)).norm(), 1e-5);
}

TEST(FocalPx, IsEmptyWhenAllViewsAreSquare) {
  const std::vector<Matrix3d> matrices = {*homography(seen(plain_lens(), tilted({0, 0, 0})))};
  const auto focal = focal_px(matrices, {620.0, 480.0});
  // Nothing is known: either nothing is said, or something absurd that the caller checks.
  EXPECT_TRUE(!focal.has_value() || focal->maxCoeff() > 30.0 * 1240.0 ||
              focal->minCoeff() < 0.2 * 1240.0);
}

TEST(BoardPose, IsExactThroughADistortingLens) {
  LensVector lens = plain_lens();
  lens.tail<5>() << -0.2, 0.1, 0.0, 0.001, -0.002;
  const Isometry3d pose = tilted({0.3, -0.4, 2.0});
  const auto found = board_pose(seen(lens, pose), lens);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(six_of(found->inverse() * pose).norm(), 1e-7);
}

}  // namespace
}  // namespace glint
