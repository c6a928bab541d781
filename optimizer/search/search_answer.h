// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a search answers by what it was told: the best design or the compromise, what is expected of
// all of them, and whether the best one keeps its limits. Private to the module.
#pragma once

#include <string>

#include "optimizer/search/replay.h"

namespace glint {

/// The name of the task's algorithm, that which `auto` stands for.
std::string algorithm_of(const SearchTask& task);

/// What the models expect of the limits; empty by rules 7 and before, without noise, without
/// limits and without models.
LimitExpectations expected_limits_of(const SearchTask& task, const SearchMemory& memory);

/// Fills in best, is_feasible, trade_off, expected, limits and judged_limits, and adds a warning
/// where the reference lies inside the front.
/// @param task  with the rules that the run follows
void take_answer(const SearchTask& task, const SearchMemory& memory, SearchResult& result);

}  // namespace glint
