// SPDX-License-Identifier: GPL-3.0-or-later
//
// Results of populations for people: sections of the report, lines of the program's output.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// The `panels` of a report (studies/report/report.h) for the objects `sorting` and `pod` of a
/// run's result.json, with the charts of its folder; empty without them. @throws IoError
nlohmann::ordered_json population_panels(const std::filesystem::path& run,
                                         const nlohmann::ordered_json& result);

/// What each lighting sorts, a line each, for the end of a run; empty where nothing is sorted.
std::string population_summary(const nlohmann::ordered_json& result);

}  // namespace glint
