// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string_view>

#include "hardware/twin/camera/bad_cable.h"

namespace glint {

/// "dropped=0.01 delay_ms=50": what a cable does from now on. Keys: dropped, doubled, swapped
/// (shares, 0 to 1), delay_ms, longest_packet, answers_resend, cut (0 or 1). Without any: a good
/// cable.
/// @return none for another text
std::optional<CableFaults> parse_cable_faults(std::string_view text);

}  // namespace glint
