// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a design is worth that is never built exactly: the merit that 95 % of the built ones reach.
#pragma once

#include <limits>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "optimizer/front/choice_cost.h"
#include "optimizer/problem/goal.h"
#include "optimizer/problem/trial.h"

namespace glint {

/// The share of built designs that may be worse than what is told of them.
inline constexpr double kWorstShare = 0.05;

/// The merit of a design that failed or is outside a limit.
inline constexpr double kNoMerit = std::numeric_limits<double>::infinity();

/// Minimised objectives of each design of a front.
using FrontRows = std::vector<std::vector<double>>;

/// One number for the scores of one built design, smaller is better: the objective (negated when
/// maximised); of several objectives choice_cost() in the ranges of the search's front.
class BuiltMerit {
 public:
  /// @param trials  of the search
  /// @param front   from which the search has chosen, of several objectives; empty: that of the
  ///                trials as they were seen
  BuiltMerit(const Goal& goal, std::span<const Trial> trials, const FrontRows& front = {});

  /// Infinity for scores that cannot be judged or are outside a limit.
  double of(const Scores& scores) const;

  /// The same without a look at limits. @param scores  with all objectives, none of them NaN
  double of_objectives(const Scores& scores) const;

 private:
  const Goal& goal_;
  FrontChoice choice_;
  std::vector<ObjectiveRange> ranges_;  ///< empty: there is one objective
};

/// The scores of all objectives and limits.
std::set<std::string> named_scores(const Goal& goal);

/// How good the built designs are together.
struct Standing {
  int too_many = 0;      ///< beyond kWorstShare outside limits or failed; 0: `reached` is finite
  double reached = 0.0;  ///< the merit that all but kWorstShare reach

  // NOLINTNEXTLINE(modernize-use-nullptr): there is no null
  auto operator<=>(const Standing&) const = default;
};

/// @param merits  of BuiltMerit, at least one; failed ones are infinite
Standing standing_of(std::vector<double> merits);

}  // namespace glint
