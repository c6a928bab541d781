// SPDX-License-Identifier: GPL-3.0-or-later
//
// Evaluations of a search against its winner's quality as files: search.json, search.html,
// run.json, and a database for each search in searches/.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/frontier/frontier_page.h"
#include "studies/frontier/search_frontier.h"

namespace glint {

/// The object of search.json, see docs/frontier.md.
nlohmann::ordered_json searches_json(const Study& study, const SearchFrontier& frontier);

/// Runs the searches, or goes on with those in the folder, and writes the chart.
/// @param methods  algorithms; empty: the study's own
/// @param seeds    >= 1
/// @return the object of search.json with the full path of the report
/// @throws ConfigError, IoError
nlohmann::ordered_json searches_study(const Study& study,
                                      const FrontierRun& run,
                                      const std::vector<std::string>& methods,
                                      int seeds);

}  // namespace glint
