// SPDX-License-Identifier: GPL-3.0-or-later
//
// Trials and their outcomes as rows of the tables trial, evaluation, value, gradient and remark.
#pragma once

#include <string_view>
#include <vector>

#include "optimizer/problem/trial.h"
#include "optimizer/storage/sqlite.h"

namespace glint {

inline constexpr std::int64_t kFirstSchemaWithGradients = 2;
inline constexpr std::int64_t kFirstSchemaWithRemarks = 3;
inline constexpr std::int64_t kFirstSchemaWithObjectives = 4;

/// As the tables have it: "search", "part".
std::string_view trial_kind_name(TrialKind kind);

/// Inserts the trial without its outcome, or replaces it.
void insert_trial(Database& database, const Trial& trial);

/// Of a trial that is there; its outcome stays.
void replace_point(Database& database, TrialKind kind, int number, const Point& point);

/// Replaces whatever outcome the trial had.
void insert_outcome(Database& database, TrialKind kind, int number, const Outcome& outcome);

void delete_outcome(Database& database, TrialKind kind, int number);

/// Those of all trials of a kind.
void delete_outcomes(Database& database, TrialKind kind);

/// All trials by number, also of earlier schemas. @throws IoError
std::vector<Trial> read_trials(Database& database, TrialKind kind);

}  // namespace glint
