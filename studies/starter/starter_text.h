// SPDX-License-Identifier: GPL-3.0-or-later
//
// A starter study as the text that a person goes on with.
#pragma once

#include <string>

#include "optimizer/problem/space.h"
#include "studies/starter/starter_plan.h"

namespace glint {

/// What the search of a starter study may change; none for kAll, which has prototypes.
SearchSpace starter_space(const StarterPlan& plan);

/// The study as commented TOML.
std::string starter_text(const StarterPlan& plan);

/// The same with a single light of a kind and nothing to search: what prototypes of kAll look like.
std::string starter_text(const StarterPlan& plan, StarterLight kind);

}  // namespace glint
