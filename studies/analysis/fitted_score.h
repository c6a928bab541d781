// SPDX-License-Identifier: GPL-3.0-or-later
//
// One score of a run's designs and the model of it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "optimizer/problem/space.h"
#include "optimizer/problem/trial.h"
#include "optimizer/surrogate/gaussian_process.h"

namespace glint {

struct FittedScore {
  std::string score;
  std::vector<Point> points;   ///< canonical designs that the model knows, each once
  std::vector<double> values;  ///< of a design that was evaluated again the mean
  GaussianProcess model;       ///< fitted, unless there are no points
  int left_out = 0;            ///< designs with this score beyond what the model takes
  int without = 0;             ///< trials that failed or lack the score
};

/// Of more than 400 designs the model takes those that lie farthest from one another.
/// @param space   checked
/// @param trials  told ones count, of any origin
FittedScore fit_score(const SearchSpace& space,
                      std::span<const Trial> trials,
                      const std::string& score);

}  // namespace glint
