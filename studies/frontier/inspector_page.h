// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frontier of the inspection as files: inspector.json, inspector.html, run.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "studies/frontier/frontier_page.h"
#include "studies/frontier/inspector_frontier.h"

namespace glint {

/// The object of inspector.json, see docs/frontier.md.
nlohmann::ordered_json inspector_json(const Study& study, const InspectorFrontier& frontier);

/// Measures the filters of the study's own scene and writes the chart into a folder, as
/// frontier_study().
/// @return the object of inspector.json with the full path of the report
/// @throws ConfigError, IoError; nothing is left behind then
nlohmann::ordered_json inspector_study(const Study& study, const FrontierRun& run);

}  // namespace glint
