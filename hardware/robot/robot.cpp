// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/robot.h"

#include <array>

namespace glint {

std::string_view name_of(MotionOutcome outcome) {
  constexpr std::array<std::string_view, 10> kNames = {"done",
                                                       "protective_stop",
                                                       "safeguard_stop",
                                                       "emergency_stop",
                                                       "unreachable",
                                                       "limit",
                                                       "program_stopped",
                                                       "timeout",
                                                       "lost",
                                                       "refused"};
  return kNames.at(static_cast<std::size_t>(outcome));
}

}  // namespace glint
