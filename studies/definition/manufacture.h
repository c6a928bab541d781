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
  std::string key;          ///< dotted path of a number of the scene
  double plus_minus = 0.0;  ///< > 0, in the key's own unit; of an integer a whole number
  bool is_integer = false;
};

/// Another value of a numeric key, rounded where its values are integers.
ConfigNode moved_value(const ConfigNode& node, double value);

/// Reads "path" = { plus_minus = .. } in the order of the file; empty without the table.
/// @param study   with scene, variables and objective
/// @param errors  grows by: no search, unknown keys, keys that are no numbers, plus_minus that is
///                not above 0, not whole for an integer or beyond the key's range
std::vector<Tolerance> read_tolerances(const Study& study, std::vector<Problem>& errors);

/// Of a study that is checked or begins a run. Runs of programs that took an empty table can still
/// be read and go on.
/// @throws ConfigError for a table without any key
void check_has_tolerances(const Study& study);

}  // namespace glint
