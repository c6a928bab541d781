// SPDX-License-Identifier: GPL-3.0-or-later
//
// The best of what a search has evaluated so far, told or not, for display.
#pragma once

#include <optional>
#include <vector>

#include "optimizer/problem/goal.h"
#include "optimizer/problem/trial.h"

namespace glint {

class BestSoFar {
 public:
  /// @param goal  must outlive it
  explicit BestSoFar(const Goal& goal) : goal_(&goal) {}

  /// @param scores  of a trial that did not fail
  void add(int number, const Scores& scores);

  /// The best feasible trial, of several objectives the compromise; else the one with the least
  /// violation; empty: there is none.
  const std::optional<int>& number() const { return best_; }

  /// Of several objectives: how many designs no other one beats in everything.
  int on_front() const { return static_cast<int>(front_.size()); }

 private:
  void add_to_front(int number, const Scores& scores);

  const Goal* goal_;
  std::optional<int> best_;
  Scores scores_;                          ///< of the best, while there is no front
  std::vector<int> front_;                 ///< trial numbers
  std::vector<std::vector<double>> rows_;  ///< minimised objectives of each
};

}  // namespace glint
