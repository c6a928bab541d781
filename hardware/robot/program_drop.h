// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "hardware/robot/motion_permit.h"
#include "hardware/robot/ur_settings.h"

namespace glint {

/// Has the controller end the program that it runs or has paused, by its dashboard: a paused one
/// would go on, and move the arm, when a person resets the stop. No script does that: it might
/// wait, too.
/// @return why the controller may still have the program; empty: it has none. Takes at most some
///         seconds, and never throws.
std::string drop_program(const UrSettings& settings, const MotionPermit& permit);

}  // namespace glint
