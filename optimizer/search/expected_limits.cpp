// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/expected_limits.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "optimizer/algorithm/acquisition.h"
#include "optimizer/algorithm/exact_values.h"
#include "optimizer/algorithm/merit.h"

namespace glint {
namespace {

/// What models expect of one score: that its limits hold, and the score itself.
struct ExpectedScore {
  double probability = 1.0;
  Expectation score;
};

/// @param limit  log_limit() of what algorithms are told
double chance_of_limit(const Expectation& limit) {
  const double room = log_limit(MeritFunction::kLimitMargin) - limit.mean;
  if (limit.sd > 0.0) {
    return std::exp(log_normal_probability(room / limit.sd));
  }
  return room >= 0.0 ? 1.0 : 0.0;
}

Expectation score_of_limit(const Constraint& constraint,
                           std::size_t index,
                           const Expectation& limit) {
  const double value = limit_of_log(limit.mean);
  const double by_log = 1.0 / log_limit_derivative(value);
  const double mean = score_at_limit(constraint, index, value);
  const double moved = score_at_limit(constraint, index, value + by_log * limit.sd);
  return {.mean = mean, .sd = std::abs(moved - mean)};
}

/// @param limits  of this constraint, first of min, then of max
ExpectedScore expected_score(const Constraint& constraint, std::span<const Expectation> limits) {
  ExpectedScore found;
  double missed = 0.0;
  double largest = -1.0;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const double miss = 1.0 - chance_of_limit(limits[i]);
    missed += miss;
    if (miss > largest) {
      largest = miss;
      found.score = score_of_limit(constraint, i, limits[i]);
    }
  }
  found.probability = std::max(0.0, 1.0 - missed);
  return found;
}

ExpectedLimits expected_limits(const Goal& goal,
                               const Scores& seen,
                               std::span<const Expectation> row,
                               std::span<const std::string> exact) {
  ExpectedLimits expected;
  std::size_t next = 0;
  for (const Constraint& constraint : goal.constraints) {
    const std::size_t count = limit_values(constraint, 0.0).size();
    ExpectedScore one = expected_score(constraint, row.subspan(next, count));
    next += count;
    if (std::ranges::find(exact, constraint.name) != exact.end()) {
      const double value = seen.at(constraint.name);
      one = {.probability = violation(constraint, value) > 0.0 ? 0.0 : 1.0,
             .score = {.mean = value, .sd = 0.0}};
    }
    expected.probability *= one.probability;
    expected.scores.push_back(one.score);
  }
  return expected;
}

}  // namespace

LimitExpectations limit_expectations_of(const Goal& goal,
                                        std::span<const Trial> trials,
                                        std::span<const int> told,
                                        std::span<const std::vector<Expectation>> rows,
                                        std::span<const std::string> exact) {
  LimitExpectations expected;
  for (std::size_t i = 0; i < std::min(told.size(), rows.size()); ++i) {
    if (!rows[i].empty()) {
      const Trial& trial = trials[static_cast<std::size_t>(told[i] - 1)];
      expected[told[i]] = expected_limits(goal, trial.outcome->scores, rows[i], exact);
    }
  }
  return expected;
}

double feasible_chance(const Goal& goal, const Trial& trial, const LimitExpectations& expected) {
  const auto found = expected.find(trial.number);
  if (found != expected.end()) {
    return found->second.probability;
  }
  return is_feasible(goal, trial.outcome->scores) ? 1.0 : 0.0;
}

bool is_likely_feasible(const Goal& goal, const Trial& trial, const LimitExpectations& expected) {
  return feasible_chance(goal, trial, expected) >= kFeasibleChance;
}

std::optional<Trial> most_likely_feasible(const Goal& goal,
                                          std::span<const Trial> trials,
                                          const LimitExpectations& expected) {
  const Trial* best = nullptr;
  double highest = 0.0;
  for (const Trial& trial : trials) {
    if (!trial.outcome || trial.outcome->is_failed) {
      continue;
    }
    const double chance = feasible_chance(goal, trial, expected);
    if (best == nullptr || chance > highest ||
        (chance == highest && is_better(goal, trial.outcome->scores, best->outcome->scores))) {
      best = &trial;
      highest = chance;
    }
  }
  return best != nullptr ? std::optional(*best) : std::nullopt;
}

}  // namespace glint
