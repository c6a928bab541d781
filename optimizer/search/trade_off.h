// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a search with several objectives has found: the designs that no other one beats in
// everything, their hypervolume, and the one that the goal's choice takes. Numbers of objectives
// are minimised ones (minimised_objectives()) unless told otherwise.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "optimizer/algorithm/answer.h"
#include "optimizer/problem/goal.h"
#include "optimizer/problem/trial.h"
#include "optimizer/search/expectations.h"
#include "optimizer/search/expected_limits.h"

namespace glint {

/// The front of feasible designs (is_likely_feasible()); empty where there is none.
struct TradeOff {
  std::vector<int> trials;                 ///< numbers, in the order of asking
  std::vector<std::vector<double>> front;  ///< objectives of each
  std::vector<double> reference;           ///< one number per objective
  double hypervolume = 0.0;                ///< in the product of the scores' units; 0 without front
  /// Half the interval of the hypervolume that follows from those of the scores on the front
  /// (objective_noise()), as if they were independent, to first order; 0 without any. Where
  /// is_expected, from the standard deviations of what is expected.
  double noise = 0.0;
  std::size_t chosen = 0;    ///< index into trials of the compromise
  std::string reason;        ///< why it was chosen, for people; empty without a front
  int outside = 0;           ///< designs of the front that are not better than the reference in all
  bool is_expected = false;  ///< made of what a model expects, not of what evaluations have shown
};

/// Where the hypervolume is measured from: the references of the goal and, for objectives without
/// one, the worst value of the initial design.
/// @param design  the trials of the initial design, all evaluated
/// @return one number per objective; empty while one is missing and no trial has succeeded
std::vector<double> reference_of(const Goal& goal, std::span<const Trial> design);

/// @param trials     those without an outcome count for nothing
/// @param reference  one number per objective; empty: that of the trials themselves
/// @param expected   what counts instead of the scores; a trial without any is not on the front.
///                   Empty: there is no model
/// @param limits     what is expected of them; empty: they are judged by what was seen
TradeOff trade_off(const Goal& goal,
                   std::span<const Trial> trials,
                   const std::vector<double>& reference,
                   const Expectations& expected = {},
                   const LimitExpectations& limits = {});

/// The feasible trial whose one objective is expected to be the best, where a model smooths what
/// evaluations with noise have shown; of equal ones the first. Empty: there is none.
/// @param told      numbers of trials in the order of telling; one may be told again
/// @param expected  a row for each of them: Algorithm::expected_objectives(); empty: no model
/// @param limits    as of trade_off()
std::optional<int> expected_best(const Goal& goal,
                                 std::span<const Trial> trials,
                                 std::span<const int> told,
                                 std::span<const std::vector<Expectation>> expected,
                                 const LimitExpectations& limits = {});

/// Hypervolume after each evaluated trial, in their order. @param expected, limits  as of
/// trade_off()
std::vector<double> hypervolume_history(const Goal& goal,
                                        std::span<const Trial> trials,
                                        const std::vector<double>& reference,
                                        const Expectations& expected = {},
                                        const LimitExpectations& limits = {});

/// The reference that a search has recorded; empty: none yet.
std::vector<double> recorded_reference(std::span<const Event> events);

/// In the unit and direction of the scores. @param objectives  one number per objective
std::vector<double> in_score_units(const Goal& goal, std::vector<double> objectives);

/// What the choice by the goal's rule needs beside the front.
FrontChoice front_choice_of(const Goal& goal);

}  // namespace glint
