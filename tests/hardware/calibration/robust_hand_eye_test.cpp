// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/robust_hand_eye.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "hardware/calibration/opencv_methods.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

const BoardSymmetry kHalfTurn{.turns = 2, .center_mm = {29.7, 23.1, 0.0}, .radius_mm = 25.0};

double degrees(double angle) {
  return angle * 180.0 / std::numbers::pi;
}

/// Exact views of the board, with the robot's poses as reported.
std::vector<PosePair> pairs_of(const SimulatedCell& cell) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
    const Isometry3d seen =
        camera_from_board(cell.settings.mounting, cell.poses, cell.true_base_from_flange[i]);
    pairs.push_back(
        {.base_from_flange = cell.base_from_flange[i],
         .camera_from_board = cell.is_flipped[i] ? seen * board_turn(kHalfTurn, 1) : seen});
  }
  return pairs;
}

// Three boards, turned by -a, 0 and a about z and 3 mm apart: about the middle one the roots of the
// mean squares are a sqrt(2 / 3) and 3 mm sqrt(2 / 3); over n - 1 they would be a and 3 mm.
TEST(BoardScatter, IsTheRootMeanSquareAboutTheMeanPlace) {
  constexpr double kTurn = 0.01;
  std::vector<PosePair> pairs;
  for (const double step : {-1.0, 0.0, 1.0}) {
    Vector6d board;
    board << 0.0, 0.0, kTurn * step, 100.0 + 3.0 * step, 20.0, 30.0;
    pairs.push_back({.base_from_flange = motion_of(board)});
  }
  const BoardScatter scatter = board_scatter(Mounting::kEyeInHand, Isometry3d::Identity(), pairs);
  EXPECT_NEAR(scatter.rotation_rad, kTurn * std::sqrt(2.0 / 3.0), 1e-9);
  EXPECT_NEAR(scatter.translation_mm, 3.0 * std::sqrt(2.0 / 3.0), 1e-9);
}

class ClosedForms : public testing::TestWithParam<Mounting> {};

TEST_P(ClosedForms, AreExactOnCleanPoses) {
  const SimulatedCell cell =
      simulate_cell({.mounting = GetParam(),
                     .num_poses = 12,
                     .noise = {.corner_px = 0, .robot_rad = 0, .robot_mm = 0}},
                    1);
  const std::vector<PosePair> pairs = pairs_of(cell);
  const auto own = park(GetParam(), pairs);
  ASSERT_TRUE(own.has_value());
  EXPECT_LT(six_of(own->hand_eye.inverse() * cell.poses.hand_eye).norm(), 1e-9);
  EXPECT_LT(six_of(own->board.inverse() * cell.poses.board).norm(), 1e-9);
  for (const HandEyeMethod method : kHandEyeMethods) {
    const auto found = hand_eye_by(method, GetParam(), pairs);
    ASSERT_TRUE(found.has_value()) << name_of(method);
    EXPECT_LT(six_of(found->hand_eye.inverse() * cell.poses.hand_eye).norm(), 1e-6)
        << name_of(method);
    EXPECT_LT(six_of(found->board.inverse() * cell.poses.board).norm(), 1e-6) << name_of(method);
  }
}

INSTANTIATE_TEST_SUITE_P(BothMountings,
                         ClosedForms,
                         testing::Values(Mounting::kEyeInHand, Mounting::kEyeToHand));

TEST(Park, IsEmptyForOneAxisAndForTwoPoses) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 6; ++i) {
    Vector6d six = Vector6d::Zero();
    six[2] = 0.2 * i;
    six[3] = i * i;
    pairs.push_back({.base_from_flange = motion_of(six), .camera_from_board = motion_of(-six)});
  }
  EXPECT_FALSE(park(Mounting::kEyeInHand, pairs).has_value());
  pairs.resize(2);
  EXPECT_FALSE(park(Mounting::kEyeInHand, pairs).has_value());
}

TEST(HandEyeMethod, HasAName) {
  EXPECT_EQ(hand_eye_method("daniilidis"), HandEyeMethod::kDaniilidis);
  EXPECT_EQ(hand_eye_method("shah"), HandEyeMethod::kShah);
  EXPECT_FALSE(hand_eye_method("Park").has_value());
}

TEST(BoardTurn, HalfATurnSwapsOppositeCorners) {
  const Vector3d corner = board_turn(kHalfTurn, 1) * Vector3d::Zero();
  EXPECT_LT((corner - Vector3d(59.4, 46.2, 0.0)).norm(), 1e-12);
}

TEST(RobustHandEye, FindsTurnedBoardsAndWrongStamps) {
  // A third turned around, a tenth with another picture's pose.
  const SimulatedCell cell = simulate_cell({.flipped_share = 0.35, .wrong_share = 0.1}, 2);
  const std::vector<PosePair> pairs = pairs_of(cell);
  const auto found = robust_hand_eye(Mounting::kEyeInHand, pairs, kHalfTurn, 1);
  ASSERT_TRUE(found.has_value());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (cell.is_wrong[i]) {
      EXPECT_FALSE(found->is_inlier[i]) << i;
    } else {
      EXPECT_EQ(found->turns[i], cell.is_flipped[i] ? 1 : 0) << i;
    }
  }
  const Vector6d miss = six_of(found->poses.hand_eye.inverse() * cell.poses.hand_eye);
  EXPECT_LT(degrees(miss.head<3>().norm()), 0.1);
  EXPECT_LT(miss.tail<3>().norm(), 0.3);
  // Negative control: the closed form alone believes all of them.
  const auto naive = park(Mounting::kEyeInHand, pairs);
  ASSERT_TRUE(naive.has_value());
  EXPECT_GT(six_of(naive->hand_eye.inverse() * cell.poses.hand_eye).tail<3>().norm(), 1.0);
}

TEST(RobustHandEye, BoardLiesAsTheFirstInlierSawIt) {
  SimulatedCell cell = simulate_cell({.num_poses = 20}, 3);
  cell.is_flipped[0] = true;
  const auto found = robust_hand_eye(Mounting::kEyeInHand, pairs_of(cell), kHalfTurn, 1);
  ASSERT_TRUE(found.has_value());
  ASSERT_TRUE(found->is_inlier[0]);
  EXPECT_EQ(found->turns[0], 0);
  EXPECT_EQ(found->turns[1], 1);
  const Isometry3d wanted = cell.poses.board * board_turn(kHalfTurn, 1);
  EXPECT_LT(degrees(angle_rad(found->poses.board.linear().transpose() * wanted.linear())), 0.2);
}

TEST(RobustHandEye, IsTheSameForTheSameSeed) {
  const std::vector<PosePair> pairs =
      pairs_of(simulate_cell({.num_poses = 30, .wrong_share = 0.2}, 4));
  const auto a = robust_hand_eye(Mounting::kEyeInHand, pairs, kHalfTurn, 5);
  const auto b = robust_hand_eye(Mounting::kEyeInHand, pairs, kHalfTurn, 5);
  EXPECT_EQ(a->poses.hand_eye.matrix(), b->poses.hand_eye.matrix());
}

}  // namespace
}  // namespace glint
