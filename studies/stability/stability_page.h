// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint stability` as files: stability.json, stability.html, run.json.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/definition/study.h"
#include "studies/stability/stability.h"

namespace glint::stability {

struct StabilityRun {
  std::filesystem::path out;
  int threads = 1;
  std::optional<double> budget_s = {};  ///< > 0; no cell is begun later
  Bounds bounds = {};
  Progress::Style progress = Progress::Style::kAuto;
};

/// One sentence on all cells.
std::string stability_sentence(const Stability& stability);

/// Measures the sweeps and writes their files, which appear together.
/// @param study  whose scene takes the place of the built-in one; null: none
/// @return the object of stability.json with the full path of the report
/// @throws ConfigError, IoError; nothing is left behind then
nlohmann::ordered_json stability_study(const Study* study,
                                       const std::vector<Sweep>& sweeps,
                                       const StabilityRun& run);

/// The same of the winner of a finished run, by measure_winner(). @param folder  of the run
nlohmann::ordered_json winner_study(const std::filesystem::path& folder, const StabilityRun& run);

}  // namespace glint::stability
