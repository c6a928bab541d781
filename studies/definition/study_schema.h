// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// The JSON schema (draft 7) of study files, for editors with a TOML language server: every key
/// with its meaning, kind, range and default. Conditions between keys are left to `glint check`.
nlohmann::ordered_json study_schema();

}  // namespace glint
