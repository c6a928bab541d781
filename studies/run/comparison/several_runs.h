// SPDX-License-Identifier: GPL-3.0-or-later
//
// Several runs side by side, as data of a report.
#pragma once

#include <filesystem>
#include <vector>

#include <nlohmann/json.hpp>

#include "studies/definition/study.h"

namespace glint {

/// One of them.
struct ReportedRun {
  std::filesystem::path folder;
  Study study;
  nlohmann::ordered_json data;    ///< of its own report, without a verdict
  nlohmann::ordered_json result;  ///< its result.json
};

/// Their designs and, in `runs`, the one that stands for each: the winner of a search, the first in
/// the ranking of designs without one. Names of runs and keys of designs are unique.
nlohmann::ordered_json several_runs(std::vector<ReportedRun> runs);

}  // namespace glint
