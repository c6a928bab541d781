// SPDX-License-Identifier: GPL-3.0-or-later
//
// The search of a study: what it varies, how a candidate is evaluated, and what was found.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "optimizer/search/search.h"
#include "studies/accuracy/outcome_labels.h"
#include "studies/definition/ladder/render_ladder.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"

namespace glint {

/// The study's search from its beginning.
/// @param study  must outlive what is returned
/// @param jobs   candidates at once, >= 1
SearchTask search_task(const Study& study, int jobs);

/// What a search wants of each candidate: the scores of its goal, and those that [accuracy] names.
WantedScores wanted_in_search(const Study& study);

/// Scores of a point of the search space, and their derivatives where the algorithm needs them.
/// @param rung  how it is rendered; nullptr: as the study says
/// @throws ConfigError for what cannot be built; IoError, also when the part's file has gone
Outcome evaluate_candidate(SceneStore& store,
                           const Study& study,
                           const Point& point,
                           const RenderRung* rung = nullptr);

/// The active variables of a point: { path: value }.
nlohmann::ordered_json variables_json(const Study& study, const Point& point);

/// The values that the study's own scene has for its variables: { path: value }.
nlohmann::ordered_json baseline_variables_json(const Study& study);

/// What a search with several objectives has found, in the units of the scores:
///
///   objectives   [ { score, direction: "maximise" | "minimise", reference } ]
///   designs      the front, [ { trial, variables, scores: { name: value } of objectives and
///                limited scores, errors: { name: standard error } of those objectives that have
///                one, expected: { name: { value, sd } } of those that noise moves and a model
///                knows, searched: { name: value } where is_expected, limits: limits_json() where
///                a model judges them,
///                contribution, shown, folder: see plan_front() } ]
///   is_expected  true where the front is of what is expected (SearchResult::of_front()): scores
///                of objectives are that, and `searched` is what was seen; else absent
///   is_likely    true where models judge the limits; else absent
///   hypervolume, noise   and half the width of its interval (TradeOff)
///   history      hypervolume after each evaluation
///   noise_history  [ [evaluations, noise] ] at some of them
///   reference    { score: value }
///   outside      designs that are not better than the reference in every objective
///   chosen       { trial, by: the choice's rule, reason }; null without a front
///
/// @param study   with several objectives
/// @param search  whose expectations count; of none without a model
nlohmann::ordered_json front_json(const Study& study,
                                  const Storage& storage,
                                  const SearchResult& search = {});

/// The finalists of a search that chooses among kinds of light (lighting_use is a variable): of
/// each kind the best design, feasible ones first, scored once more with fresh random numbers and
/// finer sampling, all in the same way and at the exposure that sensor.expose_to sets. Of several
/// objectives it is the compromise of the kind's own front.
/// @param trials     of the search
/// @param reference  of several objectives: recorded_reference(); empty: that of the trials
/// @param expected   of noisy objectives, by which the best is taken; empty: by what was seen
/// @param winner     the number of the search's best trial, which stands for its kind; 0: none
/// @param limits     what is expected of them; empty: limits are judged by what was seen
/// @return [ { lighting_use, trial, variables, scores: as the search saw them, rescored: { .. },
///           feasible: whether the rescored ones keep all limits, of several objectives
///           hypervolume: of the kind's own front, and on_front: how many designs of the whole
///           front are of this kind } ], the best of the rescored first, of several objectives
///           what the goal's choice takes of them, then of the rest; a kind of which no evaluation
///           succeeded, or which cannot be rescored, is left out. null without such a variable
/// @throws IoError
nlohmann::ordered_json best_of_each_kind(SceneStore& store,
                                         const Study& study,
                                         const std::vector<Trial>& trials,
                                         const std::vector<double>& reference = {},
                                         const Expectations& expected = {},
                                         int winner = 0,
                                         const LimitExpectations& limits = {});

/// best_of_each_kind() of a search that has ended.
/// @param search  with a best trial
/// @param fresh   gets what they gave; nullptr: it is not kept
nlohmann::ordered_json kinds_of_search(SceneStore& store,
                                       const Study& study,
                                       const Storage& storage,
                                       const SearchResult& search,
                                       FreshOutcomes* fresh = nullptr);

}  // namespace glint
