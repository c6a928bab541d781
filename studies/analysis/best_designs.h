// SPDX-License-Identifier: GPL-3.0-or-later
//
// The best design of each part of a space, through which the responses of a run are drawn.
#pragma once

#include <map>
#include <span>
#include <string>

#include "optimizer/problem/goal.h"
#include "optimizer/problem/trial.h"
#include "studies/analysis/fitted_score.h"

namespace glint {

/// Canonical points by the names of their branches (branches.h); none of a branch that has no
/// feasible design.
using BestDesigns = std::map<std::string, Point>;

/// The best feasible trials as they were seen; of several objectives the compromise of each
/// branch's own front.
BestDesigns best_seen(const SearchSpace& space, const Goal& goal, std::span<const Trial> trials);

/// The same by what models expect of each trial, for scores with noise: objectives by their means,
/// limits by the probability that all of them hold (is_likely_feasible()), limited scores taken as
/// independent.
/// @param fitted  of all scores that the goal names
/// @param exact   of these, scores that noise does not move: they stand as they were seen
BestDesigns best_expected(const SearchSpace& space,
                          const Goal& goal,
                          std::span<const Trial> trials,
                          std::span<const FittedScore> fitted,
                          std::span<const std::string> exact);

}  // namespace glint
