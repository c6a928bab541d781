// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint validate`: how far a run's designs and real pictures of them agree, why not, and whether
// the designs' ranking holds.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/validate/validated_designs.h"

namespace glint {

struct ValidateOptions {
  std::filesystem::path run;          ///< folder of glint run
  std::filesystem::path pictures;     ///< holds a folder for each design
  std::filesystem::path out;          ///< empty: out/<name of the run>/validate
  std::filesystem::path calibration;  ///< calibration.toml; empty: what acquired.json names
  std::string designs;                ///< with commas between them; empty: as [validate] says
  std::vector<LeftOutDesign> left_out = {};  ///< already, as no picture could be taken of them
  bool is_refitting = false;  ///< fits grey values in any case, scores all designs again
  int threads = 1;
  Progress::Style progress = Progress::Style::kAuto;
};

/// Writes result.json, report.html, run.json, and for each design the simulated views and a folder
/// for each picture: overlay.png, simulated.png, difference.exr; refit.toml where a refit was asked
/// for.
/// @return what result.json holds, and "folder", "report"; agreement "agrees",
///         "agrees_after_refit" or "does_not_agree"
/// @throws ConfigError, IoError; nothing is left behind
nlohmann::ordered_json validate_run(const ValidateOptions& options);

}  // namespace glint
