// SPDX-License-Identifier: GPL-3.0-or-later
//
// The table of boards in docs/theory/calibration.md: its first steps, which tell a change of the
// plan or of the information; script/bench calibrate/boards prints all of it.
#include "tests/hardware/upkeep/board_plans.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

TEST(BoardPlans, ALargerBoardIsWorthMorePicturesOfTheHandEye) {
  const std::vector<double> small = turn_sigmas_deg(kPlannedBoards[0], 1);
  ASSERT_EQ(small.size(), 2U);
  EXPECT_NEAR(small[0], 0.0625, 0.002);
  EXPECT_NEAR(small[1], 0.038, 0.0015);
  const std::vector<double> large = turn_sigmas_deg(kPlannedBoards[2], 1);
  EXPECT_LT(large[0], small[1]) << "nine pictures of the one, seventeen of the other";
}

}  // namespace
}  // namespace glint
