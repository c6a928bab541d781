// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/storage/replicate_rows.h"

#include <bit>
#include <string_view>

#include "optimizer/storage/trial_rows.h"

namespace glint {
namespace {

/// Values are NULL where they are NaN.
constexpr const char* kReplicateTables = R"sql(
CREATE TABLE replicate(
  kind TEXT NOT NULL, number INTEGER NOT NULL, rung TEXT NOT NULL, replicate INTEGER NOT NULL,
  seed INTEGER NOT NULL,
  status TEXT NOT NULL CHECK (status IN ('done', 'failed')),
  message TEXT NOT NULL, seconds REAL NOT NULL,
  PRIMARY KEY (kind, number, rung, replicate, seed)) WITHOUT ROWID;
CREATE TABLE replicate_value(
  kind TEXT NOT NULL, number INTEGER NOT NULL, rung TEXT NOT NULL, replicate INTEGER NOT NULL,
  seed INTEGER NOT NULL, name TEXT NOT NULL,
  value REAL,
  PRIMARY KEY (kind, number, rung, replicate, seed, name)) WITHOUT ROWID;
)sql";

Statement& bind_key(Statement& statement, const Replicate& replicate) {
  return statement.bind(trial_kind_name(replicate.kind))
      .bind(std::int64_t{replicate.number})
      .bind(std::string_view(replicate.rung))
      .bind(std::int64_t{replicate.replicate})
      .bind(std::bit_cast<std::int64_t>(replicate.seed));
}

void insert_replicate(Database& database, const Replicate& replicate) {
  Statement old(database,
                "DELETE FROM replicate_value WHERE kind = ? AND number = ? AND rung = ? AND "
                "replicate = ? AND seed = ?");
  bind_key(old, replicate).run();
  Statement row(database, "INSERT OR REPLACE INTO replicate VALUES(?, ?, ?, ?, ?, ?, ?, ?)");
  bind_key(row, replicate)
      .bind(std::string_view(replicate.outcome.is_failed ? "failed" : "done"))
      .bind(std::string_view(replicate.outcome.message))
      .bind(replicate.outcome.seconds)
      .run();
  Statement value(database, "INSERT INTO replicate_value VALUES(?, ?, ?, ?, ?, ?, ?)");
  for (const auto& [name, score] : replicate.outcome.scores) {
    bind_key(value, replicate).bind(std::string_view(name)).bind(score + 0.0).run();
    value.reset();
  }
}

void read_values(Database& database, Replicate& replicate) {
  Statement row(database,
                "SELECT name, value FROM replicate_value WHERE kind = ? AND number = ? AND rung = "
                "? AND replicate = ? AND seed = ?");
  bind_key(row, replicate);
  while (row.step()) {
    replicate.outcome.scores[row.text(0)] = row.real(1);
  }
}

}  // namespace

void create_replicate_tables(Database& database) {
  database.run(kReplicateTables);
}

void insert_replicates(Database& database, std::span<const Replicate> replicates) {
  for (const Replicate& replicate : replicates) {
    insert_replicate(database, replicate);
  }
}

bool has_replicate(Database& database, const Replicate& replicate) {
  Statement row(database,
                "SELECT 1 FROM replicate WHERE kind = ? AND number = ? AND rung = ? AND replicate "
                "= ? AND seed = ?");
  return bind_key(row, replicate).step();
}

std::vector<Replicate> read_replicates(Database& database, TrialKind kind) {
  std::vector<Replicate> replicates;
  if (database.integer("PRAGMA user_version") < kFirstSchemaWithReplicates) {
    return replicates;
  }
  Statement row(database,
                "SELECT number, rung, replicate, seed, status, message, seconds FROM replicate "
                "WHERE kind = ? ORDER BY number, rung, replicate, seed");
  row.bind(trial_kind_name(kind));
  while (row.step()) {
    Replicate& replicate = replicates.emplace_back();
    replicate.kind = kind;
    replicate.number = static_cast<int>(row.integer(0));
    replicate.rung = row.text(1);
    replicate.replicate = static_cast<int>(row.integer(2));
    replicate.seed = std::bit_cast<std::uint64_t>(row.integer(3));
    replicate.outcome.is_failed = row.text(4) == "failed";
    replicate.outcome.message = row.text(5);
    replicate.outcome.seconds = row.real(6);
    read_values(database, replicate);
  }
  return replicates;
}

}  // namespace glint
