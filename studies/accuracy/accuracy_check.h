// SPDX-License-Identifier: GPL-3.0-or-later
//
// Designs of a search evaluated once more at the top of its ladder: whether the bound held, and
// which of the finalists is the best there (docs/accuracy.md, "Checked").
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/search/search.h"
#include "studies/accuracy/chosen_accuracy.h"

namespace glint {

/// One design of the search at the chosen rung and at the top.
struct CheckedDesign {
  int trial = 0;
  bool is_finalist = false;  ///< it was the best when it was found; else drawn at random
  Outcome at_top;
  std::vector<std::string> beyond;  ///< scores whose error is beyond the bound
};

struct AccuracyCheck {
  std::vector<CheckedDesign> designs;
  double work = 0.0;          ///< counted
  std::optional<int> winner;  ///< trial: of the checked finalists the best at the top
};

/// Checks the winner of a finished search and, as far as a tenth of its counted work goes, the
/// designs that were the best before it, newest first, and one at random after each two of them.
/// With the search's own random numbers. Several objectives have no winner: their designs are drawn
/// at random. What is recorded is not evaluated again.
/// @throws EvaluationAborted, IoError
AccuracyCheck check_search(const AccuracyTask& task,
                           const ChosenAccuracy& chosen,
                           const std::vector<Trial>& trials);

/// Makes the best of the checked finalists the search's: feasible or not by its scores at the top.
/// @return whether another design won
bool adopt_winner(const Study& study,
                  const AccuracyCheck& check,
                  const std::vector<Trial>& trials,
                  SearchResult& search);

/// { checked, beyond: of them, work, share: of the search's counted work,
///   designs: [ { trial, finalist, beyond: [ scores ], top: { score } } ], winner: trial or null,
///   sentence }
nlohmann::ordered_json check_json(const ChosenAccuracy& chosen,
                                  const AccuracyCheck& check,
                                  int evaluations);

}  // namespace glint
