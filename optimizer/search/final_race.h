// SPDX-License-Identifier: GPL-3.0-or-later
//
// The last word on a noisy search: its finalists, and designs that it is compared with, are
// evaluated with random numbers that the search has not seen, the same ones for all.
//
// Round by round every design that is still in the race is evaluated again; one that would be
// better than the best so far in fewer than 1 % of the samples of the means is given up. Samples
// draw the replicates with replacement, the same ones for all designs (common random numbers), and
// widen what they draw to Student's distribution. Each replicate is an event and a trial of the
// study's database: what is there is not evaluated again, so a race that is cut short goes on, and
// a larger one has all of the smaller one. Only what failed is tried again, once in each run: what
// was missing may be there now.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "optimizer/problem/goal.h"
#include "optimizer/problem/trial.h"
#include "optimizer/storage/storage.h"

namespace glint {

/// Replicates of a design before the first one is given up, and at the end.
inline constexpr int kFirstReplicates = 4;
inline constexpr int kAllReplicates = 8;

struct Entrant {
  std::string key;   ///< names the design and what it is, for ever: replicates are kept under it
  int trial = 0;     ///< of the search; 0: what the search is compared with
  Point point = {};  ///< of a trial
};

/// How a race judges limits: by the means of replicates, or (by search rules 8) by the samples of
/// these means: a design that keeps all limits in less than half of them is behind all others.
enum class RaceLimits { kByMeans, kByChance };

struct Racer {
  std::vector<Scores> replicates;
  bool is_given_up = false;  ///< also one that could not be evaluated
  bool keeps_limits = true;  ///< as RaceLimits says
  double probability = 0.0;  ///< of being the best of all, 0 where given up
  /// Share of the samples of its means that keep all limits; kByChance only, and only where there
  /// are limits and replicates.
  std::optional<double> feasible_chance = {};
};

struct FinalRace {
  std::vector<Racer> racers;  ///< one per entrant
  std::size_t best = 0;       ///< index of the best one that is a trial
  int evaluations = 0;        ///< replicates of all
};

/// Designs that race where Budget::race does not say: one of twelve evaluations, 2 to 8.
int race_size(int evaluations);

/// Evaluates a design with the random numbers of that replicate. What it throws as glint::Error
/// takes the design out of the race, except IoError and EvaluationAborted.
using EvaluateReplicate = std::function<Scores(const Entrant& entrant, int replicate)>;

/// How a design is rendered for a replicate and with which random numbers.
using LabelOfReplicate = std::function<OutcomeLabel(const Entrant& entrant, int replicate)>;

/// @param entrants  at least one that is a trial
/// @param label     each outcome is recorded under it, too: of a trial of the search, or of the
///                  race's own (TrialKind::kReplicate) where the design is none. Empty: none is.
/// @return empty: interrupted
/// @throws IoError
std::optional<FinalRace> run_final_race(const Goal& goal,
                                        const std::vector<Entrant>& entrants,
                                        Storage& storage,
                                        const EvaluateReplicate& evaluate,
                                        const std::atomic<int>* interrupt = nullptr,
                                        RaceLimits limits = RaceLimits::kByMeans,
                                        const LabelOfReplicate& label = {});

}  // namespace glint
