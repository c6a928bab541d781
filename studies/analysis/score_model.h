// SPDX-License-Identifier: GPL-3.0-or-later
//
// One score of a run, modelled and taken apart: how well the model predicts, what the score owes to
// each variable, and how it answers to them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "optimizer/analysis/sobol_indices.h"
#include "optimizer/problem/goal.h"
#include "optimizer/problem/trial.h"
#include "studies/analysis/best_designs.h"
#include "studies/analysis/evidence.h"
#include "studies/analysis/fitted_score.h"

namespace glint {

/// The model's expectation with its 95 % band.
struct Band {
  double mean = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// What the score owes to a variable.
struct Importance {
  std::size_t variable = 0;
  SobolIndex index;
};

/// The score over one variable.
struct Response {
  std::size_t variable = 0;
  std::vector<double> at;     ///< in the variable's own unit; choices as index
  std::vector<Band> average;  ///< over all values of the others
  std::vector<Band> at_best;  ///< the others as in the branch's best design; empty without one
};

/// The score over two variables, averaged over the others.
struct ResponseMap {
  std::size_t x = 0;
  std::size_t y = 0;
  std::vector<double> at_x;
  std::vector<double> at_y;
  std::vector<Band> values;  ///< at_x.size() for each of at_y
};

struct BranchAnalysis {
  std::string name;  ///< see branches.h
  Evidence evidence;
  /// Empty where the evidence is not enough, as all below; in the order of the variables.
  std::vector<Importance> importance;
  std::vector<Response> responses;
  std::optional<ResponseMap> map;  ///< of the two most important variables
};

struct ScoreAnalysis {
  std::string score;
  double q2 = 0.0;
  double noise = 0.0;  ///< standard deviation of one evaluation, as fitted
  int points = 0;      ///< that the model knows
  int left_out = 0;    ///< designs with this score beyond what the model takes
  int without = 0;     ///< designs that failed or lack the score
  std::vector<BranchAnalysis> branches;
  /// What the deciding variables explain of all branches together; empty without conditions or
  /// where a branch lacks evidence.
  std::vector<Importance> choices;
  int wanted = 0;  ///< designs all over the space that would be enough, about; 0: it is
};

/// @param fitted  fit_score()
/// @param best    through which the responses `at_best` go
ScoreAnalysis analyse_score(const SearchSpace& space,
                            const FittedScore& fitted,
                            const BestDesigns& best);

/// The same with the best designs as they were seen.
/// @param trials  told ones count, of any origin
ScoreAnalysis analyse_score(const SearchSpace& space,
                            const Goal& goal,
                            std::span<const Trial> trials,
                            const std::string& score);

}  // namespace glint
