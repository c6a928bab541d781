// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is told of the rung that a search is rendered by, in one place.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/accuracy/chosen_accuracy.h"

namespace glint {

/// For result.json and the page:
///
///   tolerance    "auto" or { score: how it was written }, confidence
///   level, rung  names; settings: { samples, max_reflections } or { method,
///                max_direction_error_mrad, rays_per_axis }
///   reached      whether the rung serves; sentence: all of it in words
///   why          [ sentences ]; unreached: for each score the bound that is to be had
///   scores       of the rung: [ { score, tolerance (null with "auto"), bound, wide_bound,
///                bias, spread, top_error, top_bias, top_spread } ]
///   designs      names; failed: how many could not be evaluated
///   rungs        [ { name, level, work, for_search, tried, serves, skipped, tau: { objective },
///                bounds: { score } } ]
///   work         { unit, evaluation, checking, search, full: the same search at the top rung }
///   not_modelled [ sentences ]
///   check        of a finished run: check_json()
///
/// Where a choice changes the scene's kind, level and rung are those of all branches in one text,
/// and in place of settings, scores, designs, failed, alike, rungs and offsets there are
///
///   variable     the choice
///   tau          { objective } of all designs together, each at its branch's rung; with "auto"
///   branches     of each value: [ { value, level, rung, settings, reached, scores, designs,
///                failed, alike, rungs, share: of the search's designs,
///                work: { evaluation, checking, full_evaluation }, offsets } ]
///
/// @param evaluations   of the search, made or planned
/// @param unmodelled    unmodelled_notes()
/// @param earlier_work  of the search at cheaper rungs, before it was raised
nlohmann::ordered_json accuracy_json(const Study& study,
                                     const ChosenAccuracy& chosen,
                                     int evaluations,
                                     const std::vector<std::string>& unmodelled,
                                     double earlier_work = 0.0);

}  // namespace glint
