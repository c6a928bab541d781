// SPDX-License-Identifier: GPL-3.0-or-later
//
// What noise leaves of a search's winner: a race of its finalists with fresh random numbers
// (optimizer/search/final_race.h), and the value that the winner truly has. Both are of one
// objective; of several the front is scored again (studies/front).
#pragma once

#include <atomic>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/search/search.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"

namespace glint {

/// Whether its finalists race: [budget] race says so or, without it, [search] noisy; and the search
/// has found a design within the limits.
bool has_race(const Study& study, const SearchResult& search);

/// What a race takes where all but the winner are given up at the first chance; 0: there is none.
int likely_replicates(const Study& study, int evaluations);

/// What such a race evaluates of a design: all that the goal names, with what needs a picture of
/// its own (real pictures, trials), rendered as the study says and not as its search may be.
/// @param replicate  >= 0; each has random numbers of its own, the same ones for all designs
/// @throws ConfigError where it cannot be made; IoError
Scores replicate_scores(SceneStore& store,
                        const Study& study,
                        const SceneSettings& scene,
                        int replicate);

/// Races the finalists of a search, its prototypes, and its baseline where it is no finalist. The
/// best finalist becomes the search's best; by search rules 8 its replicates judge the limits. Each
/// replicate is kept as its event, as a trial of its own and as an outcome of the finalist
/// (repeated_label(), after the winner's repeated scans).
///
/// @return { finalists, replicates: of a design at most, evaluations, searched: the search's own
///         best trial, entrants: [ { key: "winner" | "trial_017" | "baseline" | a prototype's name,
///         title, trial, variables (of finalists), searched, expected, expected_sd (where a model
///         knows them), replicates, value, low, high: mean and 95 % interval of the objective,
///         keeps_limits, limits: limits_json() (by search rules 8, where there are any), given_up,
///         probability } ], the most probable first; probability_best: [ {
///         key, title, probability } ] }; null: interrupted
/// @throws IoError
nlohmann::ordered_json race_finalists(SceneStore& store,
                                      const Study& study,
                                      Storage& storage,
                                      SearchResult& search,
                                      const std::atomic<int>* interrupt);

/// What is told of the winner of one noisy objective: { score, seen: by the search, expected,
/// expected_sd (where a model knows them), value, low, high: told_value() of its repeated scans };
/// null where it was not scanned repeatedly or scores are not noisy.
/// @param winner  its scores.json
nlohmann::ordered_json told_winner(const Study& study,
                                   const SearchResult& search,
                                   const nlohmann::ordered_json& winner);

/// Adds what race and repeated scans came to: best.told, probability_best and race.
/// @param winner  its scores.json
/// @param race    race_finalists(), of which probability_best is taken; null: there was none
/// @param result  the object of result.json, with best
void add_race_to_result(const Study& study,
                        const SearchResult& search,
                        const nlohmann::ordered_json& winner,
                        nlohmann::ordered_json& race,
                        nlohmann::ordered_json& result);

}  // namespace glint
