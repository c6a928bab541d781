// SPDX-License-Identifier: GPL-3.0-or-later
//
// The programs that Glint sends: one motion each, framed by two writes to an output register, which
// acknowledge over RTDE that the program has begun and that it has come to its end. In between a
// thread of the program changes the register all the time: it stands still when the program has
// gone, whatever runs in its place.
#pragma once

#include <cstdint>
#include <string>

#include "hardware/robot/path_check.h"

namespace glint {

/// The values of one program, told apart from what the register held before.
struct ScriptAck {
  std::int32_t begun = 0;
  std::int32_t beat = 0;  ///< in turns with `begun` while the program runs
  std::int32_t ended = 0;

  /// @param held  in the register now; values stay within 1 to 1,000,000
  static ScriptAck after(std::int32_t held);

  bool is_of_program(std::int32_t value) const {
    return value == begun || value == beat || value == ended;
  }
};

/// movej or movel, then the end.
std::string motion_script(const CheckedMotion& motion, int ack_register, const ScriptAck& ack);

/// stopj: replaces the program that runs.
std::string stop_script(double joint_deceleration_rad_s2);

}  // namespace glint
