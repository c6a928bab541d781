// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a run has recorded so far, read from its database, also while it runs or after a kill.
#pragma once

#include <map>

#include "optimizer/problem/trial.h"
#include "tests/cli/program.h"

namespace glint::test {

/// Outcomes by trial number; empty while there is no database.
std::map<int, Outcome> recorded_evaluations(const std::filesystem::path& out);

/// Nothing recorded before is missing, changed or evaluated again: the measured seconds of an
/// evaluation never repeat.
void expect_kept(const std::map<int, Outcome>& before, const std::map<int, Outcome>& after);

}  // namespace glint::test
