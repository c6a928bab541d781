// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "optimizer/search/search.h"

namespace glint {

/// @throws ConfigError for a budget without a limit or of another kind of goal, jobs below 1, start
///                     points of another shape
void check_task(const SearchTask& task);

/// Why the outcome of an evaluation that did not fail is of no use to the task's search: scores of
/// the goal, or derivatives that its algorithm needs, are missing or not finite. Empty: nothing
std::string problem_with_outcome(const SearchTask& task,
                                 const Point& point,
                                 const Outcome& outcome);

/// Removes what the database does not keep: negative zeros, and gradients without an entry.
void make_storable(Outcome& outcome);

}  // namespace glint
