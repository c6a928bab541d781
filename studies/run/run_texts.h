// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a run says of itself, in words and as a table.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/search/search.h"
#include "studies/definition/study.h"

namespace glint {

/// "after 200 evaluations (budget.evaluations) or after 8:00:00 of searching (budget.wall_clock or
/// --budget), whichever comes first"
std::string limits_text(const Budget& budget);

/// The key of the budget that ended a search, or what else did.
std::string ended_by(Termination termination);

/// "done", "budget" (of time), "interrupted" or "no_feasible": how a run ended.
std::string run_status(const SearchResult& search, bool has_search);

/// How far a search is: "best 12.3456, 2 failed", "front of 17".
std::string progress_note(const Goal& goal, const SearchProgress& progress);

/// The first few of change_texts(); without any a file must be another one.
std::string changes_text(const std::vector<std::string>& changes);

/// "Baseline"; "Baseline (ring)" where designs without a search stand beside it under other lights.
std::string baseline_title(const Study& study);

/// All trials of a search with variables and scores, as CSV. The field of a variable whose
/// condition does not hold is empty: such a design has the file's own value.
std::string trials_csv(const Study& study, const Storage& storage);

/// The report reads a run's folder, result.json too; the verdict that it comes to belongs in there.
/// Writes both. @return the result with the verdict and the report's path
nlohmann::ordered_json with_report(nlohmann::ordered_json result, const std::filesystem::path& out);

/// What a run writes into its folder, beside the databases.
std::vector<std::string> names_in_run(const Study& study);

}  // namespace glint
