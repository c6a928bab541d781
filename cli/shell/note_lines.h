// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a result has to say beside its numbers, as lines for a terminal.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// "note: ...", a line for each text of a list.
std::string note_lines(const nlohmann::ordered_json& notes);

/// The same with "warning: ".
std::string warning_lines(const nlohmann::ordered_json& warnings);

}  // namespace glint
