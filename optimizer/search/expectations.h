// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the model of a search expects of its designs without the noise of their evaluations, and
// which of them are worth evaluating once more.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "optimizer/algorithm/answer.h"
#include "optimizer/problem/goal.h"
#include "optimizer/problem/space.h"
#include "optimizer/problem/trial.h"
#include "optimizer/search/expected_limits.h"

namespace glint {

/// One number an objective, in the unit and direction of the scores, by the number of the trial.
using Expectations = std::map<int, std::vector<Expectation>>;

/// Whether an objective of some trial tells how far noise moves it (objective_noise()).
bool tells_noise(const Goal& goal, std::span<const Trial> trials);

/// @param told  numbers of trials in the order of telling; of one told twice the last counts
/// @param rows  one for each of them: Algorithm::expected_objectives(); empty: no model
Expectations expectations_of(const Goal& goal,
                             std::span<const int> told,
                             std::span<const std::vector<Expectation>> rows);

/// With the scores of these names as they were seen: a model that knows the designs around cannot
/// know better what follows from the design alone.
Expectations with_exact_scores(const Goal& goal,
                               std::span<const Trial> trials,
                               std::span<const std::string> names,
                               Expectations expected);

/// How many finalists there may be.
struct FinalistPlaces {
  std::size_t count = 1;             ///< >= 1
  std::optional<std::size_t> kinds;  ///< index of a choice: beyond the count the best of each of
                                     ///< its values that has no design among them
};

/// The trials of one objective that are most likely the best: feasible ones by what is expected of
/// them, else by what was seen, the best first; feasible is likewise what is_likely_feasible(). Of
/// two that differ by less than 1 % of the range in every variable the worse is left out.
/// @param space  checked
/// @param first  the number of a trial that is taken in any case where it has scores, first
/// @return numbers of trials
std::vector<int> finalists_of(const Goal& goal,
                              const SearchSpace& space,
                              std::span<const Trial> trials,
                              const Expectations& expected,
                              int first,
                              const FinalistPlaces& places,
                              const LimitExpectations& limits = {});

}  // namespace glint
