// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/robot/cell_robot_settings.h"

#include "core/units.h"

namespace glint {

UrSettings test_robot(ArmModel model) {
  return {.model = model,
          .host = "127.0.0.1",
          .arm_deltas = {},
          .flange_from_tcp = {0.0, 0.0, 80.0, 0.0, 0.0, 0.0},
          .tool_radius_mm = 30.0,
          .payload_kg = 0.6,
          .payload_cog_mm = {0.0, 0.0, 40.0}};
}

MotionLimits test_limits() {
  return {.tool_speed_mm_s = 250.0,
          .tool_acceleration_mm_s2 = 500.0,
          .joint_speed_rad_s = 60.0 * kRadPerDeg,
          .joint_acceleration_rad_s2 = 120.0 * kRadPerDeg,
          .box_min_mm = {-900.0, -900.0, 0.0},
          .box_max_mm = {900.0, 900.0, 1200.0}};
}

JointVector test_start_rad() {
  return JointVector{0.0, -100.0, 100.0, -90.0, -90.0, 0.0} * kRadPerDeg;
}

}  // namespace glint
