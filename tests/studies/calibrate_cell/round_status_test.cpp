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
  EXPECT_EQ(status_of(4, 1.5, 2.0, 4), "most_rounds");
  EXPECT_EQ(status_of(4, 1.5, 2.0, 6), "");
}

// Of fifty pictures eight more can shrink a standard deviation by a fourteenth only.
TEST(RoundStatus, GoesOnWhilePosesPromiseMore) {
  const auto status = [](int round, double promised) {
    return status_after_round(round, 1.5, 1.6, 8, [promised] { return promised; });
  };
  EXPECT_EQ(status(2, 1.4), "");
  EXPECT_EQ(status(2, 1.49), "no_pose_helps");
  EXPECT_EQ(status(8, 1.4), "most_rounds") << "poses would help";
}

}  // namespace
}  // namespace glint::calibrate_cell_detail
