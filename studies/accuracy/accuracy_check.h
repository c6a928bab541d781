// SPDX-License-Identifier: GPL-3.0-or-later
//
// Designs of a finished search evaluated once more at the top of its ladder: whether the bound
// held, and which of the finalists is the best there (docs/accuracy.md, "Checked").
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/search/search.h"
#include "studies/accuracy/chosen_accuracy.h"
#include "studies/accuracy/search_review.h"

namespace glint {

struct AccuracyCheck {
  std::vector<CheckedDesign> designs;  ///< after the search, at the top
  double work = 0.0;                   ///< of them but for the first, counted
  double finalist_work = 0.0;          ///< of the first: the winner, where there is one
  std::optional<int> winner;           ///< trial: of the checked finalists the best at the top
  std::optional<int> raced;            ///< trial that a race of the finalists left as the winner
  std::vector<CheckedDesign> during;   ///< the search, since its rung was last raised
  double during_work = 0.0;
  std::vector<int> undecided;     ///< trials: SearchReview::undecided() at its end
  std::vector<EndedEpoch> ended;  ///< before
};

/// Checks the winner of a finished search and, as far as kCheckShare of its counted work goes after
/// the checks during the search, the designs that were the best before it, newest first, and one at
/// random after each two of them.
/// With the search's own random numbers. Several objectives have no winner: their designs are drawn
/// at random. What is recorded is not evaluated again. A finalist of a branch that the search
/// renders by the top stands there as the search has it.
/// @throws EvaluationAborted, IoError
AccuracyCheck check_search(const AccuracyTask& task,
                           AccuracyRecord& record,
                           const ChosenAccuracy& chosen,
                           const std::vector<Trial>& trials,
                           const SearchReview& review);

/// Makes the best of the checked finalists the search's: feasible or not by its scores at the top.
/// @return whether another design won
bool adopt_winner(const Study& study,
                  const AccuracyCheck& check,
                  const std::vector<Trial>& trials,
                  SearchResult& search);

/// { checked, beyond: of them, work, share: of the search's counted work, both with the checks
///   during the search and before epochs that ended, finalist_work: of the winner, counted apart,
///   designs: [ { trial, finalist, beyond: [ scores ], wider: [ scores ], top: { score } } ],
///   winner: trial or null,
///   during: { checked, beyond, work, designs: [ { trial, finalist, rung, beyond, wider } ] }, of
///     what random pixels decided with pixels and differences: { score: { value, error } }, and,
///     where there are some, undecided: [ trial ],
///   epochs: [ { trial, rung, evaluations, check_work, search_work, sentence } ] that ended,
///   sentence }, with the value of its branch for each design where there are some
nlohmann::ordered_json check_json(const ChosenAccuracy& chosen,
                                  const AccuracyCheck& check,
                                  int evaluations);

}  // namespace glint
