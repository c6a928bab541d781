// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// A section of the report. @param score  the objective; @param race, told  may be null
nlohmann::ordered_json noise_panel(const std::string& score,
                                   const nlohmann::ordered_json& race,
                                   const nlohmann::ordered_json& told);

}  // namespace glint
