// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint cover`: which surface the views of a scene inspect, and what each view adds.
//
//   OUT/coverage.ply   the part's surface in cells: colours, and for each face how many views,
//                      the smallest defect, incidence, lit share and what a pixel covers
//   OUT/views.csv      share that each view sees, adds and has alone; its pose
//   OUT/result.json  report.html  run.json  study.resolved.toml
#pragma once

#include <filesystem>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/definition/study.h"

namespace glint {

struct CoverOptions {
  std::filesystem::path out;
  std::filesystem::path pod;  ///< folder of a run with [pod]; empty: none
  int threads = 1;
  Progress::Style progress = Progress::Style::kAuto;
};

/// @return the object of result.json with the report's full path; docs/coverage.md
/// @throws ConfigError, IoError; nothing is left behind
nlohmann::ordered_json cover_study(const Study& study, const CoverOptions& options);

}  // namespace glint
