// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/pose_chain.h"

#include <numbers>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Vector6d random_six(Rng& rng, double turn_rad, double shift_mm) {
  Vector6d six;
  for (Eigen::Index i = 0; i < 6; ++i) {
    six[i] = (i < 3 ? turn_rad : shift_mm) * rng.normal();
  }
  return six;
}

TEST(PoseChain, GivesTheHandWorkedPlaceInHand) {
  // Camera 10 mm before the flange, flange at z = 300 looking down (half a turn about x), board at
  // z = 20: the board's origin stands 300 - 10 - 20 = 270 mm before the camera.
  Vector6d hand = Vector6d::Zero();
  hand[5] = 10.0;
  Vector6d board = Vector6d::Zero();
  board[5] = 20.0;
  Vector6d flange = Vector6d::Zero();
  flange[0] = std::numbers::pi;
  flange[5] = 300.0;
  const HandEye poses{.hand_eye = motion_of(hand), .board = motion_of(board)};
  const Isometry3d seen = camera_from_board(Mounting::kEyeInHand, poses, motion_of(flange));
  EXPECT_LT((seen.translation() - Vector3d(0.0, 0.0, 270.0)).norm(), 1e-12);
}

TEST(PoseChain, GivesTheHandWorkedPlaceBesideTheRobot) {
  // Camera at the base, flange 500 mm before it, board 20 mm before the flange.
  Vector6d flange = Vector6d::Zero();
  flange[5] = 500.0;
  Vector6d board = Vector6d::Zero();
  board[5] = 20.0;
  const HandEye poses{.board = motion_of(board)};
  const Isometry3d seen = camera_from_board(Mounting::kEyeToHand, poses, motion_of(flange));
  EXPECT_LT((seen.translation() - Vector3d(0.0, 0.0, 520.0)).norm(), 1e-12);
}

class PoseChainDerivatives : public testing::TestWithParam<Mounting> {};

TEST_P(PoseChainDerivatives, AreThoseOfDifferences) {
  for (std::uint64_t i = 0; i < 100; ++i) {
    Rng rng(4, Stream::kTest, i);
    const HandEye poses{.hand_eye = motion_of(random_six(rng, 1.0, 50.0)),
                        .board = motion_of(random_six(rng, 1.0, 300.0))};
    const Isometry3d flange = motion_of(random_six(rng, 1.0, 300.0));
    const ChainIncrement at{.hand_eye = random_six(rng, 0.1, 1.0),
                            .board = random_six(rng, 0.1, 1.0),
                            .error = random_six(rng, 0.1, 1.0)};
    const Vector3d point(12.0, -30.0, 4.0);
    PoseChain::Derivatives slopes;
    PoseChain(GetParam(), poses, flange, at).point_in_camera_mm(point, &slopes);
    for (Eigen::Index k = 0; k < 18; ++k) {
      constexpr double kStep = 1e-5;
      const auto moved_to = [&](double step) {
        ChainIncrement to = at;
        (k < 6 ? to.hand_eye : k < 12 ? to.board : to.error)[k % 6] += step;
        return PoseChain(GetParam(), poses, flange, to).point_in_camera_mm(point, nullptr);
      };
      const Vector3d slope = (moved_to(kStep) - moved_to(-kStep)) / (2.0 * kStep);
      const auto& by = k < 6 ? slopes.by_hand_eye : k < 12 ? slopes.by_board : slopes.by_error;
      EXPECT_LT((slope - by.col(k % 6)).norm(), 1e-5) << k;
    }
  }
}

TEST_P(PoseChainDerivatives, PointAndPoseAgree) {
  Rng rng(5, Stream::kTest, 0);
  const HandEye poses{.hand_eye = motion_of(random_six(rng, 1.0, 50.0)),
                      .board = motion_of(random_six(rng, 1.0, 300.0))};
  const ChainIncrement at{.error = random_six(rng, 0.1, 1.0)};
  const PoseChain chain(GetParam(), poses, motion_of(random_six(rng, 1.0, 300.0)), at);
  const Vector3d point(12.0, -30.0, 4.0);
  const Vector3d by_pose = chain.camera_from_board() * point;
  EXPECT_LT((by_pose - chain.point_in_camera_mm(point, nullptr)).norm(), 1e-10);
}

INSTANTIATE_TEST_SUITE_P(BothMountings,
                         PoseChainDerivatives,
                         testing::Values(Mounting::kEyeInHand, Mounting::kEyeToHand));

}  // namespace
}  // namespace glint
