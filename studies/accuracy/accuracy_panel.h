// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is told of the rungs of a search on the page and on a terminal.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// The section of the report: in one table level, settings, bounds, checks and what all that took
/// and full accuracy would have taken; a table of the branches where there are some; the ladders;
/// what no rung models.
/// @param accuracy  of accuracy_json()
nlohmann::ordered_json accuracy_panel(const nlohmann::ordered_json& accuracy);

/// What the terminal says: the sentence, and each score that is not reached; with branches a line
/// for each of its sentences.
std::string accuracy_text(const nlohmann::ordered_json& accuracy);

}  // namespace glint
