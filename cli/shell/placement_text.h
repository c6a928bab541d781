// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a part lies, as lines for a terminal.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// The pose of that name (translation_mm, sigma_mm, sigma_deg) in a result, a second line with how
/// much placements differ unless its `spread` (mm, deg) is null, its `notes`, and the file for
/// scenes.
std::string placed_part_text(const nlohmann::ordered_json& result,
                             const std::string& name,
                             const std::string& file);

}  // namespace glint
