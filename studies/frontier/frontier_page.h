// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frontier of a study as files: frontier.json, frontier.html, frontier.svg, run.json.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/definition/study.h"
#include "studies/frontier/frontier.h"

namespace glint {

/// The object of frontier.json, see docs/frontier.md.
nlohmann::ordered_json frontier_json(const Study& study, const Frontier& frontier);

/// One sentence on the program's own choice against plain sampling.
std::string frontier_sentence(const Frontier& frontier);

struct FrontierRun {
  std::filesystem::path out;
  int threads = 1;
  double budget_s = 600.0;  ///< wall clock; what would go beyond it is left out
  Progress::Style progress = Progress::Style::kAuto;
};

/// Measures the frontier of the study's own scene and writes it into a folder. In the folder of a
/// run it leaves the run's files alone; `glint report` then shows the frontier with the run.
/// @return the object of frontier.json with the full paths of the report and the drawing
/// @throws ConfigError, IoError; nothing is left behind then
nlohmann::ordered_json frontier_study(const Study& study, const FrontierRun& run);

}  // namespace glint
