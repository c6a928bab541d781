// SPDX-License-Identifier: GPL-3.0-or-later
//
// Trials of an earlier run as the beginning of a search (docs/analysis.md, "Warm start").
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "optimizer/search/search.h"
#include "optimizer/storage/storage.h"
#include "studies/definition/study.h"

namespace glint {

/// The trials that a run began with, in a file of their own beside study.sqlite, so that resuming
/// needs no other folder.
inline constexpr const char* kTakenTrials = "start.sqlite";

struct TakenTrials {
  std::vector<Trial> trials;   ///< as points of this study's space, with outcomes
  std::filesystem::path from;  ///< the earlier run; empty: nothing is taken
  int found = 0;               ///< trials with an outcome in the earlier run; the rest failed, lies
                               ///< outside the variables' limits or lacks a score
  std::string made_by = {};    ///< the program that evaluated them; empty: this one
};

/// What an earlier run knows of this study's space.
/// @throws ConfigError when its scores have another meaning (something but variables' limits,
///         constraints, prototypes, search, budget and how several objectives are weighed differs),
///         its variables are others, its files have changed since, the algorithm needs derivatives,
///         nothing can be taken, or the budget leaves nothing beside what is taken
/// @throws IoError     no run
TakenTrials trials_from(const Study& study, const std::filesystem::path& run);

/// The same for a run that is to begin with --from; empty without it, and where the run's folder
/// has its trials already. @throws ConfigError also when that run has begun without them, or with
/// those of another folder that is still there
TakenTrials trials_to_take(const Study& study,
                           const std::filesystem::path& from,
                           const std::filesystem::path& out);

/// Puts them into the folder of a run that has not begun, and a note into its log; nothing where
/// nothing was taken. @throws IoError
void keep_taken(const Study& study,
                const TakenTrials& taken,
                const std::filesystem::path& out,
                Storage& storage);

/// Lets a search begin with what its run took: their points are asked first.
/// @return their outcomes, which need no evaluation. @throws IoError
std::map<Point, Outcome> begin_with_taken(const std::filesystem::path& out, SearchTask& task);

}  // namespace glint
