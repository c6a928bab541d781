// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint imprint --preview_tools`: the collection of tools that a scene's groups imprint with, as a
// drawing and as files.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/study.h"
#include "studies/imprint/imprint_run.h"

namespace glint {

/// Draws the tools of a scene's groups into tools.png, tools.json and tools/NAME.stl.
/// @return { schema, status, name, tools[], files[] }
/// @throws ConfigError, IoError
nlohmann::ordered_json preview_tools(const Study& study, const ImprintOptions& options);

}  // namespace glint
