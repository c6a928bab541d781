// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs a study, or goes on with one: search, prototypes, re-scoring, files, report.
#pragma once

#include <atomic>
#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/definition/study.h"

namespace glint {

struct RunOptions {
  std::filesystem::path out;
  int threads = 1;  ///< for tracing rays
  int jobs = 1;     ///< candidates at once
  Progress::Style progress = Progress::Style::kAuto;
  std::filesystem::path log_file;               ///< beside the run's own log.txt; empty: none
  const std::atomic<int>* interrupt = nullptr;  ///< how often the user interrupted
  std::filesystem::path from;  ///< an earlier run whose trials the search begins with; empty: none
  bool verify_replay = false;  ///< SearchTask::verify_replay
};

/// Runs the study in options.out, resuming what is there.
/// A configuration that is refused leaves no folder behind.
/// @return the object of result.json (docs/conventions.md), status "done", "budget",
///         "interrupted" or "no_feasible"; and ended_by, what ended a search
/// @throws ConfigError, IoError
nlohmann::ordered_json run_study(const Study& study, const RunOptions& options);

}  // namespace glint
