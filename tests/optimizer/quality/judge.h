// SPDX-License-Identifier: GPL-3.0-or-later
//
// One search on one noisy task: what it asked, what it saw, and what its recommendation is truly
// worth.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/rng.h"
#include "tests/optimizer/quality/tasks.h"

namespace glint::quality {

/// Evaluates a task with noise and keeps everything.
class Judge {
 public:
  /// @param noise  standard deviation of what is added, in parts of each objective's spread
  Judge(const Task& task, double noise, int instance);

  /// @param x  a design of the task's space
  std::vector<double> evaluate(const std::vector<double>& x);

  std::size_t count() const { return truths_.size(); }

  /// Of the first `count` evaluations. One objective: how far the recommended one is from the
  /// optimum, in per cent of what a median random point is; several: what the recommended set
  /// covers of the whole front's hypervolume, in per cent.
  /// @param expected  what to recommend by, one row per evaluation; empty: by what was seen, as
  ///                  searches with several objectives do
  double score(std::size_t count, const std::vector<std::vector<double>>& expected) const;

 private:
  const Task& task_;
  double noise_;
  Rng rng_;
  std::vector<std::vector<double>> truths_;
  std::vector<std::vector<double>> seen_;
};

/// Scores after 50, 100 and 300 evaluations.
struct Result {
  double after_50 = 0.0;
  double after_100 = 0.0;
  double after_300 = 0.0;
  double own_ms = 0.0;   ///< of the method itself, per evaluation
  double peak_mb = 0.0;  ///< of "growth:NAME" only: memory that the search takes
};

/// "glint:NAME" (NAME of algorithm_names()) or "nlopt:NAME" (cobyla, bobyqa, direct_l,
/// direct_l_rand; started again and again from random points), or "optuna:NAME" (tpe, cmaes).
/// "derivatives:gp" is told derivatives; "growth:NAME" is the method of Glint over 10,000
/// evaluations, to be run in a process of its own.
/// @throws PeerMissing where Optuna is not installed
Result run_method(
    const std::string& method, const Task& task, double noise, int instance, int evaluations);

}  // namespace glint::quality
