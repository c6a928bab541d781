// SPDX-License-Identifier: GPL-3.0-or-later
//
// The design that is best when it is not built exactly, by evaluations of built designs: the
// search's winner and some proposals, all with the same deviations (common random numbers), in a
// race that gives up early what is surely worse.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "optimizer/robust/built_merit.h"
#include "optimizer/robust/robust_proposals.h"

namespace glint {

/// Beside the winner.
inline constexpr int kRobustCandidates = 4;
/// Built designs of each candidate between two looks at the race.
inline constexpr int kRacePart = 16;

/// The scores of each built design; empty: it failed.
using BuiltScores = std::vector<std::optional<Scores>>;

/// Evaluates designs with the offsets [first, first + count), all of each one's in their order.
/// @return one list a design; empty: interrupted
using BuildDesigns = std::function<std::vector<BuiltScores>(
    const std::vector<Point>& designs, int first, int count)>;

struct RobustCandidate {
  Point point;
  std::optional<double> modelled;  ///< Proposal::modelled; empty: the winner
  BuiltScores built;               ///< fewer than offsets: given up
  Standing standing;               ///< of these
};

/// 95 % by a bootstrap of the built designs; infinite where a limit is the trouble.
struct BuiltInterval {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};

struct RobustOptimum {
  std::vector<RobustCandidate> candidates;  ///< the winner first
  std::size_t best = 0;                     ///< index; 0: the winner is robust itself
  BuiltInterval winner;                     ///< merit that 95 % of the built ones reach
  BuiltInterval robust;
  BuiltInterval gain;  ///< winner minus robust, resampled together; 0 when best is 0
  /// Share of the samples in which the robust one is better than the winner; 0 when best is 0.
  double probability = 0.0;
  int evaluations = 0;  ///< of built designs, the winner's included
};

/// @param winner  of the search, canonical
/// @return empty: interrupted
std::optional<RobustOptimum> find_robust_optimum(const RobustTask& task,
                                                 const Point& winner,
                                                 const BuildDesigns& build);

}  // namespace glint
