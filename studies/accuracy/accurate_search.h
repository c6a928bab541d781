// SPDX-License-Identifier: GPL-3.0-or-later
//
// The search of a study with [accuracy]: how it is rendered is chosen first, and checked at its
// end.
#pragma once

#include <functional>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/search/search.h"
#include "studies/accuracy/accuracy_check.h"
#include "studies/accuracy/chosen_accuracy.h"

namespace glint {

using ChosenSearch = std::function<SearchResult(const ChosenAccuracy&, const Review&)>;

struct AccurateSearch {
  std::optional<ChosenAccuracy> chosen;  ///< empty: no [accuracy], or interrupted before
  std::optional<AccuracyCheck> check;    ///< empty: interrupted before
  double cpu_s = 0.0;                    ///< of choosing and checking, all threads
};

/// @param storage  of the search; gets the outcomes of checks and finalists at dearer rungs, each
///                 when it is made
/// @param search   searches at the rung of what was chosen, which a review may raise, and labels
///                 outcomes with it (SearchTask::label)
/// @param found    what is there when it was interrupted, too
/// @return what the search gave, with the best of the finalists at the top rung
/// @throws ConfigError, IoError
SearchResult search_accurately(const AccuracyTask& task,
                               Storage& storage,
                               const ChosenSearch& search,
                               AccurateSearch& found);

/// accuracy_json() with what the check came to. @param found  with a chosen rung
nlohmann::ordered_json accurate_search_json(SceneStore& store,
                                            const Study& study,
                                            const AccurateSearch& found,
                                            int evaluations);

}  // namespace glint
