// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// The section of the report: tables. @param spread  of tolerance_spread(), or one of a run before
/// there were robust optima
/// @param variables  of the winner: { path: value }
nlohmann::ordered_json tolerance_panel(const nlohmann::ordered_json& spread,
                                       const nlohmann::ordered_json& variables);

}  // namespace glint
