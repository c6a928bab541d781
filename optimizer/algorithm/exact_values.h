// SPDX-License-Identifier: GPL-3.0-or-later
//
// What follows from a design alone (optimizer/problem/exact_scores.h) as the numbers that an
// algorithm thinks in: objectives to minimise, and limits that must be at most 0.
#pragma once

#include <cstddef>
#include <vector>

#include "optimizer/problem/exact_scores.h"
#include "optimizer/problem/goal.h"

namespace glint {

/// sign(v) log(1 + |v|): what models of limits know from rules 4 on. The border stays at 0 and as
/// steep as it was, while a design far outside no longer decides how the model looks beside it.
double log_limit(double value);
/// Its derivative.
double log_limit_derivative(double value);
/// The value that log_limit() was taken of.
double limit_of_log(double log);

class ExactValues {
 public:
  /// Nothing is exact.
  ExactValues() = default;
  /// @param goal  checked
  ExactValues(Goal goal, ExactScores scores);

  /// From now on limits are log_limit() of what they were.
  void take_logs_of_limits() { has_log_limits_ = true; }

  /// Whether there is nothing that follows from designs alone.
  bool empty() const { return names_.empty(); }

  /// One entry per objective, then one per limit, in the order of Answer; may be shorter: then the
  /// others are not exact.
  const std::vector<bool>& is_exact() const { return is_exact_; }

  bool is_exact(std::size_t value) const { return value < is_exact_.size() && is_exact_[value]; }

  /// Numbers in the same order, NaN for those that are not exact and where the design cannot be
  /// built or has not all of the exact scores.
  std::vector<double> at(const Point& point) const;

  int max_candidates() const { return scores_.max_candidates; }

 private:
  Scores scores_at(const Point& point) const;

  Goal goal_;
  ExactScores scores_;
  std::vector<std::string> names_;  ///< of scores_ and of the goal
  std::vector<bool> is_exact_;
  bool has_log_limits_ = false;
};

}  // namespace glint
