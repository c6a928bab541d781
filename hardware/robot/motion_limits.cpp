// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/motion_limits.h"

namespace glint {

void visit_keys(KeyVisitor& keys, MotionLimits& limits) {
  constexpr Count kThree = {.min = 3, .max = 3};
  const Range box = Range::between(-3000, 3000);
  keys.number("tool_speed_mm_s",
              limits.tool_speed_mm_s,
              {.min = 0.0, .max = 1000.0, .min_excluded = true},
              "highest speed of the tool and of every link");
  keys.number("tool_acceleration_mm_s2",
              limits.tool_acceleration_mm_s2,
              {.min = 0.0, .max = 5000.0, .min_excluded = true},
              "highest acceleration along straight lines");
  keys.number("joint_speed_deg_s",
              limits.joint_speed_rad_s,
              {.min = 0.0, .max = 180.0, .min_excluded = true},
              "highest speed of any joint");
  keys.number("joint_acceleration_deg_s2",
              limits.joint_acceleration_rad_s2,
              {.min = 0.0, .max = 800.0, .min_excluded = true},
              "highest acceleration of any joint");
  keys.numbers(
      "box_min_mm", limits.box_min_mm, kThree, box, "lower corner of the arm's space, in its base");
  keys.numbers(
      "box_max_mm", limits.box_max_mm, kThree, box, "upper corner of the arm's space, in its base");
  keys.number("min_singularity_measure",
              limits.min_singularity_measure,
              Range::between(0.001, 0.1),
              "straight lines keep the smallest singular value of the Jacobian (m) above it");
  for (const std::string_view key : {"tool_speed_mm_s",
                                     "tool_acceleration_mm_s2",
                                     "joint_speed_deg_s",
                                     "joint_acceleration_deg_s2",
                                     "box_min_mm",
                                     "box_max_mm"}) {
    keys.require(keys.is_given(key), key, "is missing: limits of motion have no default");
  }
  const bool has_box = limits.box_min_mm.size() == 3 && limits.box_max_mm.size() == 3;
  for (std::size_t i = 0; has_box && i < 3; ++i) {
    keys.require(limits.box_min_mm[i] < limits.box_max_mm[i],
                 "box_max_mm",
                 "must be above box_min_mm in all three numbers");
  }
}

}  // namespace glint
