// SPDX-License-Identifier: GPL-3.0-or-later
//
// How result files tell whether a design keeps its limits where evaluations are noisy.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/search/search.h"

namespace glint {

/// By what the limits of a design are judged under noise: { probability: that all hold, by: "model"
/// | "replicates", scores: { name: { value, sd } } of what is limited, sd the standard deviation of
/// what is expected or the standard error of the mean of the replicates }.
nlohmann::ordered_json limits_json(const Goal& goal, const JudgedLimits& judged);

/// To the object of a search's best design: limits, and whether it is feasible by them. Nothing
/// where limits are judged by what was seen.
void add_judged_limits(const Goal& goal, const SearchResult& search, nlohmann::ordered_json& best);

/// To a written design, where there are limits and it does not tell yet: feasible, and limits where
/// it raced and its replicates judged them; else by its scores.
/// @param race    race_finalists() or null
/// @param design  an object of scores.json
void judge_limits(const Goal& goal,
                  const nlohmann::ordered_json& race,
                  const std::string& key,
                  nlohmann::ordered_json& design);

}  // namespace glint
