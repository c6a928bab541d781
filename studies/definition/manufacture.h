// SPDX-License-Identifier: GPL-3.0-or-later
//
// The [manufacture] table: how exactly keys of the scene can be built or set.
#pragma once

#include <string>
#include <vector>

#include "core/error.h"
#include "studies/definition/study.h"

namespace glint {

struct Tolerance {
  std::string key;          ///< dotted path of a real number of the scene
  double plus_minus = 0.0;  ///< > 0, in the key's own unit
};

/// Reads "path" = { plus_minus = .. } in the order of the file; empty without the table.
/// @param study   with scene, variables and objective
/// @param errors  grows by: no search, unknown and not real keys, plus_minus that is not above 0 or
///                beyond the key's range
std::vector<Tolerance> read_tolerances(const Study& study, std::vector<Problem>& errors);

}  // namespace glint
