// SPDX-License-Identifier: GPL-3.0-or-later
//
// How probably each design is the compromise of several objectives, for all the noise of its
// scores.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "optimizer/problem/goal.h"

namespace glint {

/// A design that may be the compromise: one of the front that was scored again, or a prototype.
struct Finalist {
  std::string key;    ///< its folder in the run's: "winner", "front/trial_017", a prototype's name
  std::string title;  ///< for people
  nlohmann::ordered_json written;  ///< scores.json: `rescored` and, if scanned so, `repeated`
};

/// The share of samples in which each finalist is what the goal's choice takes of those that no
/// other one beats in everything, objectives in parts of the ranges of the search's front.
///
/// An objective of which all finalists have the same number of scans, at least two, is the mean of
/// a bootstrap of the scans, the same ones for all (common random numbers), its deviations widened
/// to Student's distribution; else the fresh score, moved by its standard error (fresh_error() of
/// studies/front/front_designs.h), each design's by itself. Finalists whose fresh scores miss a
/// limit are not taken, unless all miss one.
///
/// @param front  of studies/run/study_search.h, with at least one design
/// @return one probability a finalist, their sum 1; empty: fewer than two have all objectives, or
///         unknown_noise() says why there is none
std::vector<double> probabilities_of_choice(const Goal& goal,
                                            const nlohmann::ordered_json& front,
                                            const std::vector<Finalist>& finalists);

/// Which score of which finalist has neither scans in common with the others nor a standard error,
/// for people; empty: none. As if it were exact it would make that finalist too sure.
std::string unknown_noise(const Goal& goal, const std::vector<Finalist>& finalists);

/// Adds `probability_best` to the designs of the front among the finalists, and the list of all,
/// [ { key, title, probability } ], the most probable first, to `result`. Without one nothing but
/// `probability_best_unknown`, unknown_noise(), where that is the reason.
void add_probability_best(const Goal& goal,
                          const std::vector<Finalist>& finalists,
                          nlohmann::ordered_json& front,
                          nlohmann::ordered_json& result);

}  // namespace glint
