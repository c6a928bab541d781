// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimizer/search/search.h"

namespace glint {

/// @throws ConfigError for a budget without a limit or of another kind of goal, jobs below 1, start
///                     points of another shape
void check_task(const SearchTask& task);

}  // namespace glint
