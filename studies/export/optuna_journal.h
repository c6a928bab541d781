// SPDX-License-Identifier: GPL-3.0-or-later
//
// A run as a journal file that Optuna 3.1 opens (JournalStorage of a JournalFileStorage), so that
// its plots and importances serve for Glint's studies, too.
//
// Each line is a JSON object: operation 0 creates the study with its directions, operation 4 a
// trial with its distributions, parameters, value, scores (user attributes) and constraints (system
// attribute "constraints": the distance beyond each limit, <= 0 inside). Inactive variables are
// left out, as Optuna leaves out what a trial did not suggest. Source: optuna 3.1.0,
// optuna/storages/_journal/storage.py.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "optimizer/problem/goal.h"
#include "optimizer/problem/trial.h"

namespace glint {

struct OptunaExport {
  std::size_t complete = 0;
  std::size_t failed = 0;      ///< of these their reason is kept
  std::size_t unfinished = 0;  ///< without an outcome: left out
};

/// The journal's text. @param counts  set; nullptr: not wanted
std::string optuna_journal(const std::string& study_name,
                           const SearchSpace& space,
                           const Goal& goal,
                           std::span<const Trial> trials,
                           OptunaExport* counts = nullptr);

/// Writes the journal of a run's search.
/// @throws ConfigError when the file exists, or the run has searched nothing
/// @throws IoError     no run, or the file cannot be written
OptunaExport export_to_optuna(const std::filesystem::path& run, const std::filesystem::path& file);

}  // namespace glint
