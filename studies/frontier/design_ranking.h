// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether cheap methods of rendering put designs into the same order as a dear one: what a search
// needs of them, rather than small errors.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "metrics/scores.h"
#include "studies/definition/study.h"
#include "studies/frontier/frontier.h"

namespace glint {

struct RankingOptions {
  int threads = 1;
  double budget_s = 120.0;  ///< wall clock; methods that would go beyond it are not tried
  std::function<void(double done, const std::string& next)> on_progress;  ///< may be empty
};

/// The order that a method gives by the objective that it orders worst: one that is not right
/// before all that are, and of these the least tau. Figures and errors are those of
/// search_figures(), [objective][design].
MethodRanking worst_order(const Goal& goal,
                          const std::vector<std::vector<double>>& cheap,
                          const std::vector<std::vector<double>>& reference,
                          const std::vector<std::vector<double>>& errors);

/// Takes out of each score by how much it is above the reference's on average over the designs, as
/// [accuracy] does of half resolution. @param reference  of the same designs, with all those scores
void take_out_mean_errors(std::span<Scores> cheap, std::span<const Scores> reference);

/// Designs that are spread evenly over the study's variables (Sobol points, the same in each run),
/// all of the scene's branch where the frontier has one, scored by the methods of a frontier, as a
/// search would: all by the same random numbers, limits counted in, scores of paths at half
/// resolution less their mean error. The reference is the dearest method at full resolution for
/// which there is time; its standard error comes from a second picture with other random numbers,
/// or, where there is no noise, from its distance to the next coarser sampling. Empty without
/// variables, without an objective that one picture gives, or without time for two methods.
/// @param frontier  after find_branch()
std::optional<DesignRanking> rank_designs(const Study& study,
                                          const Frontier& frontier,
                                          const RankingOptions& options);

}  // namespace glint
