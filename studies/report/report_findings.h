// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a verdict says beside the objective: each finding is a sentence with a code that a program
// can ask for. Private to the module.
//
//   defects_clearer, defects_fainter, defects_level   the worst defect against the baseline
//   defects_shown       its score, where there is nothing to compare with
//   defects_hidden      no design tells it from its background
//   no_defects          the scene has none: nothing says whether one would show
//   narrow_defect       a defect of less than three pixels
//   on_limits           variables of the design that lie on their limits
//   dark_part           how much of the part is dark, hidden or clipped
//   not_inspected       how much of the part the inspection looks at
//   objective_flat      almost all evaluations score the same
//   limit_lost          a limit that the design met in the search and misses with fresh seeds
//   limit_open          a limit that the design meets, with a probability below 95 % for its noise
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "studies/report/report_wording.h"

namespace glint::report_detail {

struct Finding {
  std::string code;  ///< of the list above, or of studies/report/report_verdict.h
  std::string text;  ///< a sentence for people
};

/// The score that tells how well the worst defect shows: the objective or a limit where these are
/// about defects, else its CNR.
Wording defect_wording(const nlohmann::ordered_json& data);

/// Everything of the list above that holds for a design of the data.
std::vector<Finding> findings_on(const nlohmann::ordered_json& data,
                                 const nlohmann::ordered_json& design);

/// What is said against the best of several runs: that the worst defect shows less clearly than in
/// the next one, or not at all, and the `doubts` of its own report. Empty where nothing is so.
/// @param second  nullptr: no other run has a feasible design
std::vector<Finding> doubts_on_best_run(const nlohmann::ordered_json& data,
                                        const nlohmann::ordered_json& best,
                                        const nlohmann::ordered_json* second);

}  // namespace glint::report_detail
