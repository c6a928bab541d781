// SPDX-License-Identifier: GPL-3.0-or-later
//
// The search of a study: what it varies, and how a candidate is evaluated.
#pragma once

#include "optimizer/search/search.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"

namespace glint {

/// The study's search from its beginning. @param jobs  candidates at once, >= 1
SearchTask search_task(const Study& study, int jobs);

/// What a search wants of each candidate.
WantedScores wanted_in_search(const Study& study);

/// Scores of a point of the search space, and their derivatives where the algorithm needs them.
/// @throws ConfigError for what cannot be built; IoError, also when the part's file has gone
Outcome evaluate_candidate(SceneStore& store, const Study& study, const Point& point);

}  // namespace glint
