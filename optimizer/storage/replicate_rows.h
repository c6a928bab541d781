// SPDX-License-Identifier: GPL-3.0-or-later
//
// Replicates of trials as rows of the tables replicate and replicate_value, which schema 7 brought.
#pragma once

#include <span>
#include <vector>

#include "optimizer/problem/trial.h"
#include "optimizer/storage/sqlite.h"
#include "optimizer/storage/storage.h"

namespace glint {

inline constexpr std::int64_t kFirstSchemaWithReplicates = 7;

void create_replicate_tables(Database& database);

/// Replace those of the same trial, rung, replicate and seed.
void insert_replicates(Database& database, std::span<const Replicate> replicates);

/// Whether there is one of the same trial, rung, replicate and seed.
bool has_replicate(Database& database, const Replicate& replicate);

/// By number, rung, replicate and seed; none of an earlier schema.
std::vector<Replicate> read_replicates(Database& database, TrialKind kind);

}  // namespace glint
