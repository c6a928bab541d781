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

/// The `verdict` of such a report; null without a population.
nlohmann::ordered_json population_verdict(const nlohmann::ordered_json& result);

/// A few lines for the end of a run; empty without a population.
std::string population_summary(const nlohmann::ordered_json& result);

}  // namespace glint
