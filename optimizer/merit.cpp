// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/merit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/keys.h"
#include "core/text.h"

namespace glint {

namespace {

constexpr double kMaxViolation = 1e6;
constexpr double kMaxMerit = 1e100;

double minimised(const Objective& objective, const Scores& scores) {
  const double value = scores.at(objective.name);
  return (objective.is_maximised ? -value : value) + 0.0;
}

/// How far `excess` beyond a limit is, as a part of the limit.
double relative(double excess, double limit) {
  const double unit = limit == 0.0 ? 1.0 : std::abs(limit);
  return std::min(excess / unit, kMaxViolation);
}

std::string problem_with_score(const Scores& scores,
                               const std::string& name,
                               bool may_be_infinite) {
  const auto it = scores.find(name);
  if (it == scores.end()) {
    return "there is no score \"" + name + "\"";
  }
  const bool is_good = may_be_infinite ? !std::isnan(it->second) : std::isfinite(it->second);
  return is_good ? ""
                 : "score \"" + name + "\" is " + (std::isnan(it->second) ? "NaN" : "infinite");
}

}  // namespace

void check(const Goal& goal) {
  std::vector<std::string> errors;
  if (goal.objective.name.empty()) {
    errors.emplace_back("objective: a score to maximise or minimise is needed");
  }
  for (const Constraint& constraint : goal.constraints) {
    const std::string where = "constraint on \"" + constraint.name + "\": ";
    if (!constraint.min && !constraint.max) {
      errors.emplace_back(where + "needs min, max or both");
    }
    if (constraint.min && constraint.max && *constraint.min > *constraint.max) {
      errors.emplace_back(where + "min " + shortest(*constraint.min) + " is above max " +
                          shortest(*constraint.max));
    }
    if (!std::isfinite(constraint.min.value_or(0.0)) ||
        !std::isfinite(constraint.max.value_or(0.0))) {
      errors.emplace_back(where + "limits must be finite");
    }
    if (!(constraint.weight > 0.0) || !std::isfinite(constraint.weight)) {
      errors.emplace_back(where + "weight must be above 0");
    }
  }
  throw_if_any(errors);
}

std::string problem_with(const Goal& goal, const Scores& scores) {
  std::string problem = problem_with_score(scores, goal.objective.name, false);
  for (const Constraint& constraint : goal.constraints) {
    if (problem.empty()) {
      problem = problem_with_score(scores, constraint.name, true);
    }
  }
  return problem;
}

double violation(const Constraint& constraint, double score) {
  if (constraint.min && score < *constraint.min) {
    return relative(*constraint.min - score, *constraint.min);
  }
  if (constraint.max && score > *constraint.max) {
    return relative(score - *constraint.max, *constraint.max);
  }
  return 0.0;
}

double violation(const Goal& goal, const Scores& scores) {
  double sum = 0.0;
  for (const Constraint& constraint : goal.constraints) {
    sum += constraint.weight * violation(constraint, scores.at(constraint.name));
  }
  return sum;
}

bool is_feasible(const Goal& goal, const Scores& scores) {
  return std::ranges::all_of(goal.constraints, [&scores](const Constraint& constraint) {
    return violation(constraint, scores.at(constraint.name)) <= 0.0;
  });
}

bool is_better(const Goal& goal, const Scores& a, const Scores& b) {
  const double violation_a = violation(goal, a);
  const double violation_b = violation(goal, b);
  if (violation_a > 0.0 || violation_b > 0.0) {
    return violation_a < violation_b;
  }
  return minimised(goal.objective, a) < minimised(goal.objective, b);
}

MeritFunction::MeritFunction(SearchSpace space, Goal goal, FailurePolicy policy, int num_scale)
    : space_(std::move(space)), goal_(std::move(goal)), policy_(policy), num_scale_(num_scale) {}

double MeritFunction::next(const Point& point, const Outcome& outcome) {
  std::vector<double> unit = unit_from_point(space_, point);
  ++num_told_;
  if (outcome.is_failed) {
    return failed_merit(unit);
  }
  const double objective = minimised(goal_.objective, outcome.scores);
  if (num_told_ <= num_scale_ || !smallest_) {
    widen_spread(objective);
  }
  double penalty = 0.0;
  for (const Constraint& constraint : goal_.constraints) {
    const double part = violation(constraint, outcome.scores.at(constraint.name));
    penalty += constraint.weight * std::log1p(part);
  }
  const double merit = objective + penalty_scale() * penalty;
  told_.push_back({std::move(unit), std::clamp(merit, -kMaxMerit, kMaxMerit)});
  return told_.back().merit;
}

void MeritFunction::widen_spread(double objective) {
  if (!smallest_) {
    smallest_ = objective;
    largest_ = objective;
  }
  smallest_ = std::min(*smallest_, objective);
  largest_ = std::max(largest_, objective);
}

double MeritFunction::penalty_scale() const {
  const double spread = smallest_ ? largest_ - *smallest_ : 0.0;
  // One value alone has no spread; its size is the best guess then.
  const double fallback = smallest_ && *smallest_ != 0.0 ? std::abs(*smallest_) : 1.0;
  return kPenaltyFactor * (spread > 0.0 ? spread : fallback);
}

double MeritFunction::failed_merit(const std::vector<double>& unit) const {
  if (told_.empty()) {
    return kUnknownMerit;
  }
  if (policy_ == FailurePolicy::kWorst) {
    return std::ranges::max_element(told_, {}, &Told::merit)->merit;
  }
  double nearest = std::numeric_limits<double>::infinity();
  double merit = 0.0;
  for (const Told& told : told_) {
    double squared = 0.0;
    for (std::size_t i = 0; i < unit.size(); ++i) {
      squared += (told.unit[i] - unit[i]) * (told.unit[i] - unit[i]);
    }
    if (squared < nearest) {
      nearest = squared;
      merit = told.merit;
    }
  }
  return merit;
}

}  // namespace glint
