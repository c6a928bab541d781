// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a search is for: the scores to optimise, and limits of others.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "optimizer/front/compromise.h"

namespace glint {

/// A score to optimise. What follows its direction counts where there are several.
struct Objective {
  std::string name;
  bool is_maximised = true;
  std::optional<double> reference = {};   ///< the worst value of interest; in the score's unit
  std::optional<double> aspiration = {};  ///< the value hoped for; better than the reference
  double weight = 1.0;                    ///< > 0, of ChoiceRule::kWeights and kAspirations
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
  std::vector<Objective> more_objectives = {};  ///< beside the first one
  ChoiceRule choice = ChoiceRule::kKnee;        ///< which design of several objectives' front
};

/// All of them, the first one first.
std::vector<Objective> objectives_of(const Goal& goal);
int num_objectives(const Goal& goal);

inline bool has_several_objectives(const Goal& goal) {
  return !goal.more_objectives.empty();
}

/// @throws ConfigError: no objective, one twice, an aspiration that is not better than the
///                      reference, a choice without what it needs, a constraint without limits, min
///                      above max, weight <= 0
void check(const Goal& goal);

}  // namespace glint
