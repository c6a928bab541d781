// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is wrong with the task of a search. Private to the module.
#pragma once

#include "optimizer/search/search.h"

namespace glint {

/// @throws ConfigError for a wrong budget, number of jobs or start point
void check_task(const SearchTask& task);

}  // namespace glint
