// SPDX-License-Identifier: GPL-3.0-or-later
//
// One study in one SQLite file: its trials, their outcomes and the ordered events.
//
// The events are the state of a search: nothing else is needed to go on after kill -9, because
// every algorithm is deterministic (optimizer/search/search.h replays them). Each change is one
// transaction. Numbers come back bit for bit.
//
// Tables: study (one row), session (one row per process that ran it), trial, evaluation, value,
// gradient, remark, event, replicate, replicate_value. Schema 1 had no gradients and 2 no remarks,
// which were a text in the message of an evaluation that did not fail, 3 no objectives in its
// events, 5 no epochs, and 6 no replicates: one outcome a trial was all there was; such a database
// is read as it is and upgraded when it is opened for running. They are for reading with other
// tools too; the schema number is SQLite's user_version.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "optimizer/problem/trial.h"

namespace glint {

/// What makes a study the same study.
struct StudyIdentity {
  std::string config_hash;   ///< of everything that changes results; decides what may be resumed
  std::string config_text;   ///< for people
  std::string code_version;  ///< for people
  std::uint64_t seed = 1;
};

/// What tells the outcomes of a trial apart.
struct OutcomeLabel {
  std::string rung;        ///< how it was rendered
  int replicate = 0;       ///< 0: with the random numbers that the search has
  std::uint64_t seed = 1;  ///< of the random numbers
};

/// One of several outcomes of a trial. A search goes on from the trial's own alone.
struct Replicate {
  TrialKind kind = TrialKind::kSearch;
  int number = 0;    ///< of the trial
  std::string rung;  ///< these three as in OutcomeLabel
  int replicate = 0;
  std::uint64_t seed = 1;
  Outcome outcome;  ///< derivatives and remarks are not kept
};

/// The outcome of a trial under its label.
Replicate labelled(const OutcomeLabel& label, TrialKind kind, int number, Outcome outcome);

/// Safe to use from several threads.
class Storage {
 public:
  static constexpr int kSchema = 7;

  /// Opens the study's database for running, or creates it; the folder must exist. Only one process
  /// may hold it; the lock ends with the process, however that ends. Safe against kill -9, not
  /// against power loss.
  /// @throws ConfigError when it holds another study (another config_hash)
  /// @throws IoError     when it is locked by another process, damaged, truncated, no database, of
  ///                     another program or of a newer schema, or cannot be written
  static Storage open(const std::filesystem::path& path, const StudyIdentity& identity);

  /// Opens an existing database for reading, also while another process runs it.
  /// @throws IoError
  static Storage read(const std::filesystem::path& path);

  Storage(Storage&&) noexcept;
  Storage& operator=(Storage&&) noexcept;
  ~Storage();

  /// Appends events, and trials that the asks or replicates among them name for the first time,
  /// with their outcomes where they have some, and replicates as record() does, in one transaction:
  /// either all of it survives a crash or nothing.
  void append(std::span<const Event> events,
              std::span<const Trial> new_trials = {},
              std::span<const Replicate> replicates = {});

  /// Records a trial that needs no event (an inspected part), or replaces it.
  void put_trial(const Trial& trial);

  /// Records the outcome of a trial that exists, and replicates as below, in one transaction.
  void record(TrialKind kind,
              int number,
              const Outcome& outcome,
              std::span<const Replicate> replicates = {});

  /// Records outcomes of trials that exist, in one transaction, and replaces those of the same
  /// trial, rung, replicate and seed. What a search goes on from they do not change.
  void record(std::span<const Replicate> replicates);

  /// The same of those alone whose trial, rung, replicate and seed have no outcome yet.
  void record_missing(std::span<const Replicate> replicates);

  /// Appends a kEpoch event and withdraws the outcomes of all search trials, in one transaction.
  void begin_epoch(const Event& event);

  /// Goes on as another study whose trials are the same designs: the points of all search trials
  /// are replaced, their outcomes stay, and the event is appended, in one transaction.
  /// @param points  of all search trials, by number
  void become(const StudyIdentity& identity, const std::vector<Point>& points, const Event& event);

  /// Notes how long this process has been searching.
  void set_session_seconds(double seconds);
  /// Over all processes that ran this study.
  double total_seconds() const;

  StudyIdentity identity() const;                   ///< as it was when the study began or became
  std::vector<Event> events() const;                ///< in order
  std::vector<Trial> trials(TrialKind kind) const;  ///< by number
  /// By number, rung, replicate and seed.
  std::vector<Replicate> replicates(TrialKind kind) const;

 private:
  struct State;

  explicit Storage(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace glint
