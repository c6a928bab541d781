// SPDX-License-Identifier: GPL-3.0-or-later
//
// The winner of a finished run, disturbed by what nobody would mean to change: another seed, a
// facet more, a tenth of a pixel of blur. Is it still better than the runner-up?
#pragma once

#include <filesystem>

#include "optimizer/problem/space.h"
#include "studies/definition/study.h"
#include "studies/stability/stability.h"

namespace glint::stability {

/// Two designs of a search.
struct RunnersUp {
  Study study;   ///< as the run resolved it
  Point winner;  ///< as result.json has it
  Point second;  ///< the best of those that differ from it by kApart of a range, else of all others
  int winner_trial = 0;
  int second_trial = 0;
};

/// Of the range of one variable at least: a search ends among designs that are the same but for
/// digits.
inline constexpr double kApart = 0.05;

/// @param run  folder of a run with one objective and two judged designs
/// @throws ConfigError, IoError
RunnersUp runners_up(const std::filesystem::path& run);

/// Cells of measure_winner() together.
int count_winner_cells(const RunnersUp& run);

/// Sweeps winner_seed, winner_blur and, where the part has a known surface, winner_facets, as the
/// study's own settings render them: a cell is wrong where the order of the two designs turns round
/// by more than its bound, which is that of the bounds or two standard errors of the lead.
Stability measure_winner(const RunnersUp& run, const StabilityOptions& options);

}  // namespace glint::stability
