// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a part lies, as lines for a terminal.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// `name` with the pose (translation_mm, sigma_mm, sigma_deg) of a result, and a second line with
/// how much placements differ unless `spread` (mm, deg) is null.
std::string placement_text(const std::string& name,
                           const nlohmann::ordered_json& pose,
                           const nlohmann::ordered_json& spread);

}  // namespace glint
