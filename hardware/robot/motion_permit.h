// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/error.h"

namespace glint {

/// Leave to move a robot: given by a person who typed --move on the command line of this very call,
/// by nothing else. Everything that sends scripts, releases brakes or unlocks asks for one, and no
/// file can make one.
class MotionPermit {
 public:
  /// @param is_move_typed  --move stands on the command line
  /// @param verb           for the message: "cell move"
  /// @throws ConfigError when it does not
  static MotionPermit from_command_line(bool is_move_typed, const std::string& verb) {
    if (!is_move_typed) {
      throw ConfigError("glint " + verb +
                        ": moves the robot or lets it move; nothing was sent to it. When nobody "
                        "is within its reach, type the same command with --move");
    }
    return {};
  }

 private:
  MotionPermit() = default;
};

}  // namespace glint
