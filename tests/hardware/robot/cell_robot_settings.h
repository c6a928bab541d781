// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hardware/robot/ur_settings.h"

namespace glint {

/// A robot on 127.0.0.1 with a tool of 80 mm and a payload of 0.6 kg, in a box that holds it in
/// every pose above the table.
UrSettings test_robot(ArmModel model);
MotionLimits test_limits();

/// A pose in the middle of the arm's space.
JointVector test_start_rad();

}  // namespace glint
