// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether designs keep their limits where evaluations are noisy: by what the models of a search
// expect of the limited scores, and not by what one evaluation happened to show.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "optimizer/algorithm/answer.h"
#include "optimizer/problem/goal.h"
#include "optimizer/problem/trial.h"

namespace glint {

/// A design that keeps all limits with at least this probability counts as feasible.
inline constexpr double kFeasibleChance = 0.5;

/// What is expected of the limited scores of one design.
struct ExpectedLimits {
  double probability = 1.0;         ///< that all limits hold, scores taken as independent
  std::vector<Expectation> scores;  ///< one a constraint of the goal, in the unit of its score
};

/// By the number of the trial.
using LimitExpectations = std::map<int, ExpectedLimits>;

/// Means and standard deviations of models become probabilities of the normal distribution. Where a
/// score has two limits, each with a model, the probability of both is that of one plus that of the
/// other less 1, as for one normal score; its expectation is by the limit that is less sure. Models
/// know log_limit() of a limit, so the deviation of the score is one to first order.
/// @param trials  trial number n at index n - 1
/// @param told    numbers of trials in the order of telling; of one told twice the last counts
/// @param rows    one for each of them: Algorithm::expected_limits(); empty: no model
/// @param exact   scores that follow from a design alone: these stand as they were seen
/// @return empty where there are no limits
LimitExpectations limit_expectations_of(const Goal& goal,
                                        std::span<const Trial> trials,
                                        std::span<const int> told,
                                        std::span<const std::vector<Expectation>> rows,
                                        std::span<const std::string> exact);

/// That a trial keeps all limits: 1 or 0, as it was seen, where nothing is expected of it.
/// @param trial  whose scores can be judged
double feasible_chance(const Goal& goal, const Trial& trial, const LimitExpectations& expected);

/// Whether that is at least kFeasibleChance.
bool is_likely_feasible(const Goal& goal, const Trial& trial, const LimitExpectations& expected);

/// The trial that keeps the limits most probably; of equal ones the better as it was seen. Empty:
/// none succeeded. Where nothing is expected it is the best as it was seen.
std::optional<Trial> most_likely_feasible(const Goal& goal,
                                          std::span<const Trial> trials,
                                          const LimitExpectations& expected = {});

}  // namespace glint
