// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs a study, or goes on with one: search, prototypes, re-scoring, files, report.
#pragma once

#include <atomic>
#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/study.h"

namespace glint {

struct RunOptions {
  std::filesystem::path out;
  int threads = 1;  ///< for tracing rays
  int jobs = 1;     ///< candidates at once
  Progress::Style progress = Progress::Style::kAuto;
  std::filesystem::path log_file;               ///< beside the run's own log.txt; empty: none
  const std::atomic<int>* interrupt = nullptr;  ///< how often the user interrupted
};

/// Runs the study in options.out, resuming what is there.
/// A configuration that is refused leaves no folder behind.
/// @return the object of result.json (docs/conventions.md), status "done", "budget",
///         "interrupted" or "no_feasible"
/// @throws ConfigError, IoError
nlohmann::ordered_json run_study(const Study& study, const RunOptions& options);

/// One evaluation of the baseline and of each prototype, and two for each variable to see whether
/// it acts; nothing written.
/// @return { schema, status, name, variables, idle_variables, baseline, prototypes, evaluations,
///         seconds_per_evaluation, predicted_s }
nlohmann::ordered_json check_study(const Study& study, int threads, int jobs);

/// The study's own scene and nothing to search: what a rendered folder describes.
Study scene_study(Study study);

/// Renders the study's own scene into a folder; no search. Scenes that need paths go to
/// render_views().
nlohmann::ordered_json render_study(const Study& study,
                                    const std::filesystem::path& out,
                                    int threads);

}  // namespace glint
