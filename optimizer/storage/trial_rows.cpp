// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/storage/trial_rows.h"

#include <array>
#include <map>
#include <string>
#include <string_view>

#include "core/error.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 3> kTrialKinds = {"search", "part", "replicate"};

/// The trials that are read, and where each of them is.
struct TrialList {
  std::vector<Trial> trials;
  std::map<int, std::size_t> index_of;

  /// nullptr: the trial is not known or was not evaluated.
  Outcome* outcome_of(std::int64_t number) {
    const auto it = index_of.find(static_cast<int>(number));
    const bool is_there = it != index_of.end() && trials[it->second].outcome;
    return is_there ? &*trials[it->second].outcome : nullptr;
  }
};

/// Without scores, gradients and remarks; those that earlier schemas had in the message are there.
TrialList read_evaluations(Database& database, TrialKind kind) {
  TrialList list;
  Statement row(database,
                "SELECT t.number, t.name, t.point, e.status, e.message, e.seconds FROM trial t "
                "LEFT JOIN evaluation e ON e.kind = t.kind AND e.number = t.number "
                "WHERE t.kind = ? ORDER BY t.number");
  row.bind(trial_kind_name(kind));
  while (row.step()) {
    Trial trial{.kind = kind,
                .number = static_cast<int>(row.integer(0)),
                .name = row.text(1),
                .point = row.doubles(2)};
    if (!row.is_null(3)) {
      trial.outcome = Outcome{
          .is_failed = row.text(3) == "failed", .message = row.text(4), .seconds = row.real(5)};
      if (!trial.outcome->is_failed) {
        trial.outcome->remarks = remarks_from_text(trial.outcome->message);
        trial.outcome->message.clear();
      }
    }
    list.index_of[trial.number] = list.trials.size();
    list.trials.push_back(std::move(trial));
  }
  return list;
}

void read_scores(Database& database, TrialKind kind, TrialList& list) {
  Statement row(database, "SELECT number, name, value FROM value WHERE kind = ?");
  row.bind(trial_kind_name(kind));
  while (row.step()) {
    if (Outcome* outcome = list.outcome_of(row.integer(0))) {
      outcome->scores[row.text(1)] = row.real(2);
    }
  }
}

void read_gradients(Database& database, TrialKind kind, TrialList& list) {
  Statement row(database,
                "SELECT number, score, variable, value FROM gradient WHERE kind = ? "
                "ORDER BY number, score, variable");
  row.bind(trial_kind_name(kind));
  while (row.step()) {
    Outcome* outcome = list.outcome_of(row.integer(0));
    if (outcome == nullptr) {
      continue;
    }
    std::vector<double>& gradient = outcome->gradients[row.text(1)];
    if (row.integer(2) != static_cast<std::int64_t>(gradient.size())) {
      throw IoError(database.path().string() + ": a gradient of trial " +
                    std::to_string(row.integer(0)) + " has holes, the study database is damaged");
    }
    gradient.push_back(row.real(3));
  }
}

void read_remarks(Database& database, TrialKind kind, TrialList& list) {
  Statement row(database,
                "SELECT number, count, text FROM remark WHERE kind = ? ORDER BY number, position");
  row.bind(trial_kind_name(kind));
  while (row.step()) {
    if (Outcome* outcome = list.outcome_of(row.integer(0))) {
      Remark& remark = outcome->remarks.emplace_back();
      remark.text = row.text(2);
      if (!row.is_null(1)) {
        remark.count = row.integer(1);
      }
    }
  }
}

}  // namespace

std::string_view trial_kind_name(TrialKind kind) {
  return kTrialKinds[static_cast<std::size_t>(kind)];
}

void insert_trial(Database& database, const Trial& trial) {
  Statement(database, "INSERT OR REPLACE INTO trial VALUES(?, ?, ?, ?)")
      .bind(trial_kind_name(trial.kind))
      .bind(std::int64_t{trial.number})
      .bind(std::string_view(trial.name))
      .bind_doubles(trial.point)
      .run();
}

void delete_outcome(Database& database, TrialKind kind, int number) {
  for (const char* table : {"remark", "gradient", "value", "evaluation"}) {
    Statement(database, std::string("DELETE FROM ") + table + " WHERE kind = ? AND number = ?")
        .bind(trial_kind_name(kind))
        .bind(std::int64_t{number})
        .run();
  }
}

void delete_outcomes(Database& database, TrialKind kind) {
  for (const char* table : {"remark", "gradient", "value", "evaluation"}) {
    Statement(database, std::string("DELETE FROM ") + table + " WHERE kind = ?")
        .bind(trial_kind_name(kind))
        .run();
  }
}

void replace_point(Database& database, TrialKind kind, int number, const Point& point) {
  Statement(database, "UPDATE trial SET point = ? WHERE kind = ? AND number = ?")
      .bind_doubles(point)
      .bind(trial_kind_name(kind))
      .bind(std::int64_t{number})
      .run();
}

void insert_outcome(Database& database, TrialKind kind, int number, const Outcome& outcome) {
  delete_outcome(database, kind, number);
  const auto begin = [&](Statement& statement) -> Statement& {
    return statement.bind(trial_kind_name(kind)).bind(std::int64_t{number});
  };
  const auto row = [&](const char* sql) {
    Statement statement(database, sql);
    begin(statement);
    return statement;
  };
  row("INSERT INTO evaluation VALUES(?, ?, ?, ?, ?)")
      .bind(std::string_view(outcome.is_failed ? "failed" : "done"))
      .bind(std::string_view(outcome.message))
      .bind(outcome.seconds)
      .run();
  Statement insert_value(database, "INSERT INTO value VALUES(?, ?, ?, ?)");  // once for dozens
  for (const auto& [name, value] : outcome.scores) {
    begin(insert_value).bind(std::string_view(name)).bind(value + 0.0).run();
    insert_value.reset();
  }
  for (const auto& [score, gradient] : outcome.gradients) {
    for (std::size_t i = 0; i < gradient.size(); ++i) {
      row("INSERT INTO gradient VALUES(?, ?, ?, ?, ?)")
          .bind(std::string_view(score))
          .bind(static_cast<std::int64_t>(i))
          .bind(gradient[i] + 0.0)
          .run();
    }
  }
  for (std::size_t i = 0; i < outcome.remarks.size(); ++i) {
    row("INSERT INTO remark VALUES(?, ?, ?, ?, ?)")
        .bind(static_cast<std::int64_t>(i))
        .bind(outcome.remarks[i].count)
        .bind(std::string_view(outcome.remarks[i].text))
        .run();
  }
}

std::vector<Trial> read_trials(Database& database, TrialKind kind) {
  TrialList list = read_evaluations(database, kind);
  read_scores(database, kind, list);
  const std::int64_t schema = database.integer("PRAGMA user_version");
  if (schema >= kFirstSchemaWithGradients) {
    read_gradients(database, kind, list);
  }
  if (schema >= kFirstSchemaWithRemarks) {
    read_remarks(database, kind, list);
  }
  return std::move(list.trials);
}

}  // namespace glint
