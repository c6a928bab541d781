// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a search is for: the score to optimise, and limits of others.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace glint {

/// The score to optimise.
struct Objective {
  std::string name;
  bool is_maximised = true;
};

/// Limits of a score, both inclusive.
struct Constraint {
  std::string name;
  std::optional<double> min;
  std::optional<double> max;
  double weight = 1.0;  ///< > 0, of the penalty
};

struct Goal {
  Objective objective;
  std::vector<Constraint> constraints;
};

/// @throws ConfigError: no objective, a constraint without limits, min above max, weight <= 0
void check(const Goal& goal);

}  // namespace glint
