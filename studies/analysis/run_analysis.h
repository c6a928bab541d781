// SPDX-License-Identifier: GPL-3.0-or-later
//
// A run taken apart: its objective and limited scores, modelled and analysed (docs/analysis.md).
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"

namespace glint {

struct AddOptions {
  int count = 0;  ///< designs that there shall be in all, >= 1
  int threads = 1;
  Progress::Style progress = Progress::Style::kAuto;
};

/// Evaluates space-filling designs until the run's analysis has `count`: the first ones of a Sobol
/// sequence, each recorded when it is done, so that a killed call goes on where it ended. Those of
/// rungs that the search has left since ([accuracy]) are evaluated again. The run's own trials stay
/// as they are.
/// @return how many were evaluated now
/// @throws ConfigError when the run has searched nothing; IoError
int add_designs(const std::filesystem::path& run, const AddOptions& options);

/// Of the run's trials and added designs: {
///   added         number of added designs that were evaluated, by the rungs of the search
///   scores        [ { score, q2, noise, points, left_out, without, wanted,
///     branches    [ { name, q2, points, is_enough, wanted, reason,
///       importance  [ { variable, first, first_low, first_high, total, total_low, total_high } ]
///       responses   [ { variable, at, average, average_low, average_high, best, best_low,
///                     best_high } ], lists of the same length; those of the best design may be
///                     empty. Under noise it is the run's own answer (result.json) and, in other
///                     branches, what is expected to be the best
///       map         { x, y, at_x, at_y, mean, low, high }, lists row by row of y; or null } ]
///     choices     as importance } ] }
/// @throws ConfigError when the run has searched nothing; IoError when it is no run
nlohmann::ordered_json analyse_run(const std::filesystem::path& run);

}  // namespace glint
