// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint run` of a study with [calibration_trial]: pictures of a board are rendered and written as
// files, calibrated from these files as `glint calibrate` does it, and compared with the truth.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/definition/study.h"

namespace glint {

struct TrialOptions {
  std::filesystem::path out;
  int threads = 1;
  std::vector<KeyValue> sets = {};  ///< of the calibration, as --set of glint calibrate
  Progress::Style progress = Progress::Style::kAuto;
  const std::atomic<int>* interrupt = nullptr;  ///< how often the user interrupted
};

/// Pictures that are in the folder already, of the same study, are kept.
/// @param study  with a [calibration_trial]
/// @return the object of result.json (docs/calibration_trial.md), status "done" or "interrupted"
/// @throws ConfigError, IoError; a configuration that is refused leaves no folder behind
nlohmann::ordered_json run_calibration_trial(const Study& study, const TrialOptions& options);

/// Renders the first two pictures, looks for the board in them, and tells what a run will cost.
/// Nothing is written.
/// @param study  with a [calibration_trial]
/// @return schema, status "sound", study, pictures, views [{accepted, reason, corners, blur_px,
///         contrast}], predicted_cpu_s, predicted_s
/// @throws ConfigError, IoError
nlohmann::ordered_json check_calibration_trial(const Study& study, int threads);

/// What check_calibration_trial() says, for a terminal.
std::string trial_check_text(const nlohmann::ordered_json& result);

/// Whether a folder holds a finished trial.
bool is_calibration_trial(const std::filesystem::path& folder);

/// The page of a finished trial, made anew from its files. @throws IoError, ConfigError
std::string calibration_trial_report(const std::filesystem::path& folder);

/// What the result says, for a terminal.
std::string trial_summary(const nlohmann::ordered_json& result);

}  // namespace glint
