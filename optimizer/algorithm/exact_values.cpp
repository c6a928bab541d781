// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/exact_values.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "optimizer/algorithm/merit.h"

namespace glint {

double log_limit(double value) {
  return std::copysign(std::log1p(std::abs(value)), value);
}

double log_limit_derivative(double value) {
  return 1.0 / (1.0 + std::abs(value));
}

double limit_of_log(double log) {
  return std::copysign(std::expm1(std::abs(log)), log);
}

ExactValues::ExactValues(Goal goal, ExactScores scores)
    : goal_(std::move(goal)), scores_(std::move(scores)) {
  GLINT_CHECK(scores_.max_candidates >= 1, "at least one candidate");
  const auto look_at = [this](const std::string& name, std::size_t count) {
    const bool is_exact = std::ranges::find(scores_.names, name) != scores_.names.end();
    is_exact_.insert(is_exact_.end(), count, is_exact);
    if (is_exact) {
      names_.push_back(name);
    }
  };
  for (const Objective& objective : objectives_of(goal_)) {
    look_at(objective.name, 1);
  }
  for (const Constraint& constraint : goal_.constraints) {
    look_at(constraint.name, limit_values(constraint, 0.0).size());
  }
}

/// Empty where the design cannot be built or lacks one of them.
Scores ExactValues::scores_at(const Point& point) const {
  try {
    Scores scores = scores_.at(point);
    const bool has_all =
        std::ranges::all_of(names_, [&](const std::string& name) { return scores.contains(name); });
    return has_all ? scores : Scores{};
  } catch (const Error&) {
    return {};
  }
}

std::vector<double> ExactValues::at(const Point& point) const {
  std::vector<double> values(is_exact_.size(), std::nan(""));
  const Scores scores = scores_at(point);
  if (scores.empty()) {
    return values;  // its evaluation will fail and say why
  }
  std::size_t next = 0;
  for (const Objective& objective : objectives_of(goal_)) {
    if (is_exact_[next]) {
      const double value = scores.at(objective.name);
      values[next] = objective.is_maximised ? -value : value;
    }
    ++next;
  }
  for (const Constraint& constraint : goal_.constraints) {
    const bool is_exact = next < is_exact_.size() && is_exact_[next];
    for (const double value :
         limit_values(constraint, is_exact ? scores.at(constraint.name) : std::nan(""))) {
      values[next++] = has_log_limits_ ? log_limit(value) : value;
    }
  }
  return values;
}

}  // namespace glint
