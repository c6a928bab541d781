// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/best_designs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "optimizer/algorithm/acquisition.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/search/expectations.h"
#include "optimizer/search/expected_limits.h"
#include "optimizer/search/trade_off.h"
#include "studies/analysis/branches.h"

namespace glint {
namespace {

/// Trials that can be judged, with canonical points, numbered from 1.
std::vector<Trial> judged_trials(const SearchSpace& space,
                                 const Goal& goal,
                                 std::span<const Trial> trials) {
  std::vector<Trial> judged;
  for (const Trial& trial : trials) {
    if (trial.outcome && !trial.outcome->is_failed &&
        problem_with(goal, trial.outcome->scores).empty()) {
      judged.push_back(trial);
      judged.back().number = static_cast<int>(judged.size());
      judged.back().point = canonical(space, trial.point);
    }
  }
  return judged;
}

std::vector<Point> points_of(std::span<const Trial> trials) {
  std::vector<Point> points;
  for (const Trial& trial : trials) {
    points.push_back(trial.point);
  }
  return points;
}

/// Of one objective: the likely feasible trial that is expected to be the best, of equal ones the
/// first.
const Trial* best_of_one(const Goal& goal,
                         const std::vector<Trial>& trials,
                         const Expectations& expected,
                         const LimitExpectations& limits) {
  const double sign = goal.objective.is_maximised ? -1.0 : 1.0;
  const Trial* best = nullptr;
  double least = 0.0;
  for (const Trial& trial : trials) {
    const auto known = expected.find(trial.number);
    const double value = known != expected.end()
                             ? sign * known->second.front().mean
                             : minimised_objectives(goal, trial.outcome->scores).front();
    if (is_likely_feasible(goal, trial, limits) && (best == nullptr || value < least)) {
      best = &trial;
      least = value;
    }
  }
  return best;
}

const Trial* best_of_branch(const Goal& goal,
                            const std::vector<Trial>& trials,
                            const Expectations& expected,
                            const LimitExpectations& limits) {
  if (!has_several_objectives(goal)) {
    return best_of_one(goal, trials, expected, limits);
  }
  const TradeOff found = trade_off(goal, trials, {}, expected, limits);
  return found.trials.empty()
             ? nullptr
             : &*std::ranges::find(trials, found.trials[found.chosen], &Trial::number);
}

/// @param trials  of judged_trials()
BestDesigns best_of_each(const SearchSpace& space,
                         const Goal& goal,
                         const std::vector<Trial>& trials,
                         const Expectations& expected,
                         const LimitExpectations& limits) {
  std::map<std::string, std::vector<Trial>> branches;
  const std::vector<std::string> names = branch_names(space, points_of(trials));
  for (std::size_t k = 0; k < trials.size(); ++k) {
    branches[names[k]].push_back(trials[k]);
  }
  BestDesigns best;
  for (const auto& [name, members] : branches) {
    if (const Trial* trial = best_of_branch(goal, members, expected, limits)) {
      best[name] = trial->point;
    }
  }
  return best;
}

/// What is expected of one score of each trial, in their order.
std::vector<Expectation> expected_score(const std::vector<Trial>& trials,
                                        const std::string& score,
                                        std::span<const FittedScore> fitted,
                                        std::span<const std::string> exact) {
  const auto known = std::ranges::find(fitted, score, &FittedScore::score);
  const bool is_exact = std::ranges::find(exact, score) != exact.end();
  std::vector<Expectation> expected;
  if (known == fitted.end() || known->points.empty() || is_exact) {
    for (const Trial& trial : trials) {
      expected.push_back({.mean = trial.outcome->scores.at(score), .sd = 0.0});
    }
    return expected;
  }
  for (const Posterior& posterior : known->model.predict(points_of(trials))) {
    expected.push_back({.mean = posterior.mean, .sd = std::sqrt(posterior.variance)});
  }
  return expected;
}

/// That a score keeps a limit. @param room  from its mean to the limit, negative beyond it
/// @param sd  of the score, >= 0
double chance_of_room(double room, double sd) {
  if (sd > 0.0) {
    return std::exp(log_normal_probability(room / sd));
  }
  return room >= 0.0 ? 1.0 : 0.0;
}

double chance_of_limits(const Constraint& constraint, const Expectation& score) {
  double chance = 1.0;
  if (constraint.min) {
    chance -= 1.0 - chance_of_room(score.mean - *constraint.min, score.sd);
  }
  if (constraint.max) {
    chance -= 1.0 - chance_of_room(*constraint.max - score.mean, score.sd);
  }
  return std::max(0.0, chance);
}

}  // namespace

BestDesigns best_seen(const SearchSpace& space, const Goal& goal, std::span<const Trial> trials) {
  return best_of_each(space, goal, judged_trials(space, goal, trials), {}, {});
}

BestDesigns best_expected(const SearchSpace& space,
                          const Goal& goal,
                          std::span<const Trial> trials,
                          std::span<const FittedScore> fitted,
                          std::span<const std::string> exact) {
  const std::vector<Trial> judged = judged_trials(space, goal, trials);
  Expectations objectives;
  for (const Objective& objective : objectives_of(goal)) {
    const std::vector<Expectation> expected = expected_score(judged, objective.name, fitted, exact);
    for (std::size_t k = 0; k < judged.size(); ++k) {
      objectives[judged[k].number].push_back(expected[k]);
    }
  }
  LimitExpectations limits;
  for (const Constraint& constraint : goal.constraints) {
    const std::vector<Expectation> expected =
        expected_score(judged, constraint.name, fitted, exact);
    for (std::size_t k = 0; k < judged.size(); ++k) {
      ExpectedLimits& of_trial = limits[judged[k].number];
      of_trial.probability *= chance_of_limits(constraint, expected[k]);
      of_trial.scores.push_back(expected[k]);
    }
  }
  return best_of_each(space, goal, judged, objectives, limits);
}

}  // namespace glint
