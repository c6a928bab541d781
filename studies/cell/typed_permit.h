// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "hardware/robot/motion_permit.h"

namespace glint {

/// The permit that `--move` on the command line gives.
/// @param verb  for the message: "cell move"
/// @throws ConfigError without it
inline MotionPermit typed_permit(bool is_move_typed, const std::string& verb) {
  return MotionPermit::from_command_line(is_move_typed, verb);
}

}  // namespace glint
