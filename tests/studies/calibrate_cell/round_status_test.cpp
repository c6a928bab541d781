// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/round_status.h"

#include <gtest/gtest.h>

namespace glint::calibrate_cell_detail {
namespace {

/// Where nothing is known of the next poses.
std::string status_of(int round, double missed, double before, int max_rounds) {
  return status_after_round(round, missed, before, max_rounds, [missed] { return missed; });
}

// 0.2 px of 0.3 are two thirds, 0.06 mm of 0.04 are one and a half.
TEST(RoundStatus, IsGoodWhereAllThatIsAskedForIsReached) {
  const RoundErrors errors = {.point_px = 0.2, .hand_eye_mm = 0.06, .hand_eye_deg = 0.006};
  EXPECT_NEAR(missed_by(errors, {}), 2.0 / 3.0, 1e-12);
  const RoundTargets hand_eye = {.hand_eye_mm = 0.04, .hand_eye_deg = 0.012};
  EXPECT_NEAR(missed_by(errors, hand_eye), 1.5, 1e-12);
  EXPECT_NEAR(missed_by(errors, {.hand_eye_deg = 0.003}), 2.0, 1e-12);
  EXPECT_EQ(status_of(1, 2.0 / 3.0, 0.0, 4), "good");
  EXPECT_EQ(status_of(1, 1.5, 0.0, 4), "");
}

TEST(RoundStatus, EndsWhereRoundsHelpNoMoreOrAreUsedUp) {
  EXPECT_EQ(status_of(2, 1.5, 1.6, 4), "no_pose_helps");
  EXPECT_EQ(status_of(2, 1.5, 2.0, 4), "");
  EXPECT_EQ(status_of(6, 1.1, 1.15, 20), "") << "a few rounds more would do";
  EXPECT_EQ(status_of(6, 1.1, 1.15, 7), "no_pose_helps");
  EXPECT_EQ(status_of(4, 1.5, 2.0, 4), "max_rounds");
  EXPECT_EQ(status_of(4, 1.5, 2.0, 6), "");
}

// Of fifty pictures eight more can shrink a standard deviation by a fourteenth only.
TEST(RoundStatus, GoesOnWhilePosesPromiseMore) {
  const auto status = [](int round, double promised) {
    return status_after_round(round, 1.5, 1.6, 8, [promised] { return promised; });
  };
  EXPECT_EQ(status(2, 1.4), "");
  EXPECT_EQ(status(2, 1.49), "no_pose_helps");
  EXPECT_EQ(status(8, 1.4), "max_rounds") << "poses would help";
}

TEST(RoundStatus, NothingIsPlannedAfterTheLastRound) {
  const auto plan = [] {
    ADD_FAILURE() << "a round that never follows was planned";
    return 1.5;
  };
  EXPECT_EQ(status_after_round(8, 1.5, 1.6, 8, plan), "max_rounds");
}

// Pictures for the hand-eye tell nothing of what others would make of the point error.
TEST(RoundStatus, PosesForThePointErrorAreTriedBeforeItEnds) {
  const RoundTargets targets = {.point_px = 0.1, .hand_eye_mm = 1.0};
  const RoundErrors by_point = {.point_px = 0.3, .hand_eye_mm = 0.5};
  EXPECT_FALSE(is_hand_eye_worst(by_point, targets));
  EXPECT_TRUE(is_hand_eye_worst({.point_px = 0.3, .hand_eye_mm = 4.0}, targets));
  EXPECT_FALSE(is_hand_eye_worst({.point_px = 0.01, .hand_eye_mm = 4.0}, {})) << "not asked for";
  const auto status = [](bool was_for_hand_eye, bool is_for_hand_eye) {
    return status_after_round(3, 1.5, 1.6, 8, [&] {
      return promise_of(was_for_hand_eye, is_for_hand_eye, 1.5, [] { return 1.49; });
    });
  };
  EXPECT_EQ(status(true, false), "");
  EXPECT_EQ(status(false, false), "no_pose_helps");
  EXPECT_EQ(status(true, true), "no_pose_helps");
  EXPECT_DOUBLE_EQ(promise_of(false, true, 1.5, [] { return 1.2; }), 1.2) << "as the plan has it";
}

}  // namespace
}  // namespace glint::calibrate_cell_detail
