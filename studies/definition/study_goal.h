// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tables that say what a study is for: [objective] or [[objective]], [choice], [constraints].
// Part of study.h.
#pragma once

#include <vector>

#include "core/config/keys.h"
#include "optimizer/problem/goal.h"
#include "studies/definition/study.h"

namespace glint {

/// Reads them from study.root; scene, variables, search and budget are known by then.
/// @param errors  grows by the problems found
void read_goal(Study& study, std::vector<Problem>& errors);

/// Whether the scene has every score that the goal names. @param errors  grows by those it has not
void check_goal(const Study& study, std::vector<Problem>& errors);

/// Their rows of the key table.
std::vector<KeyRow> goal_keys();

}  // namespace glint
