// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/arm_motion.h"

#include <gtest/gtest.h>

#include "tests/hardware/robot/cell_robot_settings.h"

namespace glint {
namespace {

void advance_to_end(ArmMotion& motion, double step_s) {
  while (motion.is_moving()) {
    ASSERT_EQ(motion.advance(step_s), "");
  }
}

// Slowing down at 0.8 rad/s2 and stopping at the same deceleration end at one place, whenever the
// stop comes and however long a step is: 0.04 s are those of a twin that runs 20 times too fast.
TEST(ArmMotion, AStopWhileItSlowsDownEndsAtItsGoal) {
  const Arm arm(ArmModel::kUr3e);
  const JointVector start_rad = test_start_rad();
  const JointVector goal_rad = start_rad + JointVector{0.5, -0.1, 0.2, 0.0, 0.0, 0.3};
  for (const double step_s : {0.008, 0.04}) {
    for (int before = 1; before < static_cast<int>(1.9 / step_s); ++before) {
      ArmMotion motion(arm, start_rad);
      motion.start_joints(goal_rad, 0.4, 0.8);
      for (int i = 0; i < before && motion.is_moving(); ++i) {
        ASSERT_EQ(motion.advance(step_s), "");
      }
      motion.start_stop(0.8);
      advance_to_end(motion, step_s);
      // Up 0.5 s, 0.75 s at full speed, down 0.5 s.
      const bool is_slowing = before * step_s > 1.25;
      const double left_rad = (goal_rad - motion.joints_rad())[0];
      EXPECT_GE(left_rad, -1e-9) << before << " steps of " << step_s;
      if (is_slowing) {
        EXPECT_NEAR(left_rad, 0.0, 1e-9) << before << " steps of " << step_s;
      }
    }
  }
}

}  // namespace
}  // namespace glint
