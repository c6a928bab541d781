// SPDX-License-Identifier: GPL-3.0-or-later
//
// When a variable of a study takes part.
#pragma once

#include <vector>

#include "core/config/config.h"
#include "optimizer/problem/space.h"

namespace glint {

/// Reads `when = "path == value"` or `when = "path in [value, value]"` into the variable.
/// @param errors  grows by the problem found
void read_condition(const ConfigNode& node, Variable& variable, std::vector<Problem>& errors);

}  // namespace glint
