// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/view_plan.h"

#include <array>

namespace glint {

std::string_view name_of(ViewOutcome outcome) {
  constexpr std::array<std::string_view, 7> kNames = {
      "planned", "unreachable", "joint_limit", "singular", "box", "collision", "no_path"};
  return kNames.at(static_cast<std::size_t>(outcome));
}

}  // namespace glint
