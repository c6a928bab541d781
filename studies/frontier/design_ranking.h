// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether cheap methods of rendering put designs into the same order as a dear one: what a search
// needs of them, rather than small errors.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "studies/definition/study.h"
#include "studies/frontier/frontier.h"

namespace glint {

struct RankingOptions {
  int threads = 1;
  double budget_s = 120.0;  ///< wall clock; methods that would go beyond it are not tried
  std::function<void(double done, const std::string& next)> on_progress;  ///< may be empty
};

/// Designs that are spread evenly over the study's variables (Sobol points, the same in each run),
/// scored by the methods of a frontier, as a search would: all by the same random numbers. The
/// reference is the dearest method at full resolution for which there is time; its standard error
/// comes from a second picture with other random numbers, or, where there is no noise, from its
/// distance to the next coarser sampling. Empty without variables, without an objective that one
/// picture gives, or without time for two methods.
std::optional<DesignRanking> rank_designs(const Study& study,
                                          const Frontier& frontier,
                                          const RankingOptions& options);

}  // namespace glint
