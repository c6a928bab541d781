// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// What `glint plan` prints: a line a view, the tour, the files.
/// @param result  plan_study()
std::string plan_text(const nlohmann::ordered_json& result);

/// 0 when every view can be taken, else 1.
int plan_exit_code(const nlohmann::ordered_json& result);

}  // namespace glint
