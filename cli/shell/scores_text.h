// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// The scores of a rendered scene for a terminal: those of the scene with unit, standard error and
/// meaning, then a table with a line for each defect. @param scores  name -> value
std::string scores_text(const nlohmann::ordered_json& scores);

}  // namespace glint
