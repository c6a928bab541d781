// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/storage/storage.h"

#include <sqlite3.h>

#include <array>
#include <bit>
#include <fstream>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "optimizer/storage/lock_file.h"
#include "optimizer/storage/replicate_rows.h"
#include "optimizer/storage/sqlite.h"
#include "optimizer/storage/trial_rows.h"

namespace glint {

namespace {

/// "GLNT": marks our databases among other programs' SQLite files.
constexpr std::int64_t kApplicationId = 0x474C4E54;

/// "rules" and "model" are of schema 5, "epoch" of 6, "replicate" of 7; the tables are those of
/// schema 4.
constexpr std::array<std::string_view, 10> kEventKinds = {"ask",
                                                          "tell",
                                                          "restart",
                                                          "abandon",
                                                          "note",
                                                          "reference",
                                                          "rules",
                                                          "model",
                                                          "epoch",
                                                          "replicate"};

constexpr const char* kTables = R"sql(
CREATE TABLE study(
  id INTEGER PRIMARY KEY CHECK (id = 1),
  config_hash TEXT NOT NULL, config_text TEXT NOT NULL, code_version TEXT NOT NULL,
  seed INTEGER NOT NULL);
CREATE TABLE session(number INTEGER PRIMARY KEY, seconds REAL NOT NULL);
CREATE TABLE trial(
  kind TEXT NOT NULL, number INTEGER NOT NULL, name TEXT NOT NULL,
  point BLOB NOT NULL, -- little-endian doubles
  PRIMARY KEY (kind, number)) WITHOUT ROWID;
CREATE TABLE evaluation(
  kind TEXT NOT NULL, number INTEGER NOT NULL,
  status TEXT NOT NULL CHECK (status IN ('done', 'failed')),
  message TEXT NOT NULL, seconds REAL NOT NULL,
  PRIMARY KEY (kind, number)) WITHOUT ROWID;
CREATE TABLE value(
  kind TEXT NOT NULL, number INTEGER NOT NULL, name TEXT NOT NULL,
  value REAL, -- NULL is NaN
  PRIMARY KEY (kind, number, name)) WITHOUT ROWID;
CREATE TABLE event(
  seq INTEGER PRIMARY KEY, kind TEXT NOT NULL, trial INTEGER NOT NULL, value REAL,
  text TEXT NOT NULL);
)sql";

/// Of schema 2; `variable` counts from 0 in the order of the point.
constexpr const char* kGradientTable = R"sql(
CREATE TABLE gradient(
  kind TEXT NOT NULL, number INTEGER NOT NULL, score TEXT NOT NULL,
  variable INTEGER NOT NULL,
  value REAL, -- NULL is NaN
  PRIMARY KEY (kind, number, score, variable)) WITHOUT ROWID;
)sql";

/// Of schema 4; little-endian doubles, NULL where there is one objective.
constexpr const char* kObjectivesColumn = "ALTER TABLE event ADD COLUMN objectives BLOB";

/// Of schema 3; `position` counts from 0. Before, the message of a success held its remarks.
constexpr const char* kRemarkTable = R"sql(
CREATE TABLE remark(
  kind TEXT NOT NULL, number INTEGER NOT NULL, position INTEGER NOT NULL,
  count INTEGER, -- NULL: none
  text TEXT NOT NULL,
  PRIMARY KEY (kind, number, position)) WITHOUT ROWID;
)sql";

template <class Enum, std::size_t N>
Enum value_of(const std::string& name,
              const std::array<std::string_view, N>& names,
              const std::filesystem::path& path) {
  for (std::size_t i = 0; i < N; ++i) {
    if (names[i] == name) {
      return static_cast<Enum>(i);
    }
  }
  throw IoError(path.string() + ": unknown kind \"" + name + "\", the study database is damaged");
}

std::uint64_t big_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char byte : bytes) {
    value = (value << 8) | static_cast<unsigned char>(byte);
  }
  return value;
}

/// SQLite reads a page that is cut short as if zeros followed, so the size is compared with what
/// the header says (bytes 16-17: page size, 1 means 65536; bytes 28-31: number of pages). A
/// database with a write-ahead log may be shorter: the rest is in the log.
void check_complete(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path log = path.string() + "-wal";
  if (std::filesystem::exists(log, error) && std::filesystem::file_size(log, error) > 0) {
    return;
  }
  std::ifstream file(path, std::ios::binary);
  std::array<char, 100> header = {};
  file.read(header.data(), header.size());
  const std::string_view bytes(header.data(), header.size());
  if (!file || !bytes.starts_with("SQLite format 3")) {
    return;  // SQLite itself has a word for that
  }
  const std::uint64_t page_size = big_endian(bytes.substr(16, 2));
  const std::uint64_t size = big_endian(bytes.substr(28, 4)) * (page_size == 1 ? 65536 : page_size);
  if (std::filesystem::file_size(path) < size) {
    throw IoError(path.string() + ": the study database is truncated");
  }
}

void check_readable(Database& database) {
  const std::string name = database.path().string();
  if (std::filesystem::file_size(database.path()) == 0) {
    throw IoError(name + ": the study database is damaged or truncated: it is empty");
  }
  if (database.integer("PRAGMA application_id") != kApplicationId) {
    throw IoError(name + ": is a database of another program, not of a study");
  }
  const std::int64_t schema = database.integer("PRAGMA user_version");
  if (schema > Storage::kSchema) {
    throw IoError(name + ": was written by a newer Glint (schema " + std::to_string(schema) +
                  ", this program knows " + std::to_string(Storage::kSchema) + ")");
  }
  const std::string health = database.text("PRAGMA quick_check(1)");
  if (health != "ok") {
    throw IoError(name + ": the study database is damaged or truncated: " + health);
  }
}

StudyIdentity read_identity(Database& database) {
  Statement row(database, "SELECT config_hash, config_text, code_version, seed FROM study");
  if (!row.step()) {
    throw IoError(database.path().string() + ": the study database is damaged: it names no study");
  }
  return {.config_hash = row.text(0),
          .config_text = row.text(1),
          .code_version = row.text(2),
          .seed = std::bit_cast<std::uint64_t>(row.integer(3))};
}

/// Written under another name and renamed when whole, so that a kill in between leaves no database
/// instead of half a one.
void create(const std::filesystem::path& path, const StudyIdentity& identity) {
  const std::filesystem::path unfinished = path.string() + ".new";
  std::error_code ignored;
  std::filesystem::remove(unfinished, ignored);
  std::filesystem::remove(unfinished.string() + "-journal", ignored);
  {
    Database database(unfinished, Database::Access::kCreate);
    database.run("PRAGMA application_id = " + std::to_string(kApplicationId));
    database.run("PRAGMA user_version = " + std::to_string(Storage::kSchema));
    database.run(kTables);
    database.run(kGradientTable);
    database.run(kRemarkTable);
    database.run(kObjectivesColumn);
    create_replicate_tables(database);
    Statement(database, "INSERT INTO study VALUES(1, ?, ?, ?, ?)")
        .bind(std::string_view(identity.config_hash))
        .bind(std::string_view(identity.config_text))
        .bind(std::string_view(identity.code_version))
        .bind(std::bit_cast<std::int64_t>(identity.seed))
        .run();
  }
  std::error_code error;
  std::filesystem::rename(unfinished, path, error);
  if (error) {
    throw IoError(path.string() + ": cannot be created: " + error.message());
  }
}

/// From an earlier schema to this one, wholly or not at all.
void upgrade(Database& database) {
  const std::int64_t schema = database.integer("PRAGMA user_version");
  if (schema == Storage::kSchema) {
    return;
  }
  Transaction transaction(database);
  if (schema < kFirstSchemaWithGradients) {
    database.run(kGradientTable);
  }
  if (schema < kFirstSchemaWithRemarks) {
    database.run(kRemarkTable);
  }
  if (schema < kFirstSchemaWithObjectives) {
    database.run(kObjectivesColumn);
  }
  create_replicate_tables(database);
  database.run("PRAGMA user_version = " + std::to_string(Storage::kSchema));
  transaction.commit();
}

void insert_event(Database& database, const Event& event) {
  Statement row(database,
                "INSERT INTO event(kind, trial, value, text, objectives) VALUES(?, ?, ?, ?, ?)");
  row.bind(kEventKinds[static_cast<std::size_t>(event.kind)])
      .bind(std::int64_t{event.trial})
      .bind(event.value + 0.0)
      .bind(std::string_view(event.text));
  if (event.objectives.empty()) {
    row.bind(std::optional<std::int64_t>());
  } else {
    row.bind_doubles(event.objectives);
  }
  row.run();
}

std::int64_t begin_session(Database& database) {
  Transaction transaction(database);
  database.run("INSERT INTO session(seconds) VALUES(0)");
  const std::int64_t number = sqlite3_last_insert_rowid(database.handle());
  transaction.commit();
  return number;
}

}  // namespace

Replicate labelled(const OutcomeLabel& label, TrialKind kind, int number, Outcome outcome) {
  return {.kind = kind,
          .number = number,
          .rung = label.rung,
          .replicate = label.replicate,
          .seed = label.seed,
          .outcome = std::move(outcome)};
}

struct Storage::State {
  State(const std::filesystem::path& path, Database::Access access) : database(path, access) {}

  // The lock is declared first, so that it is dropped last.
  std::unique_ptr<LockFile> lock;
  mutable std::mutex mutex;
  mutable Database database;
  std::int64_t session = 0;
};

Storage::Storage(std::unique_ptr<State> state) : state_(std::move(state)) {}

Storage::Storage(Storage&&) noexcept = default;
Storage& Storage::operator=(Storage&&) noexcept = default;
Storage::~Storage() = default;

Storage Storage::open(const std::filesystem::path& path, const StudyIdentity& identity) {
  auto lock = std::make_unique<LockFile>(path.string() + ".lock");
  if (!std::filesystem::exists(path)) {
    create(path, identity);
  }
  check_complete(path);
  auto state = std::make_unique<State>(path, Database::Access::kReadWrite);
  state->lock = std::move(lock);
  check_readable(state->database);
  if (read_identity(state->database).config_hash != identity.config_hash) {
    throw ConfigError(path.string() +
                      ": holds another study; choose another output folder, or remove this one");
  }
  state->database.run("PRAGMA journal_mode = WAL");
  state->database.run("PRAGMA synchronous = NORMAL");
  upgrade(state->database);
  state->session = begin_session(state->database);
  return Storage(std::move(state));
}

Storage Storage::read(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) {
    throw IoError(path.string() + ": there is no study database");
  }
  check_complete(path);
  // Whoever runs a study keeps a write-ahead log beside the database.
  const bool is_running = std::filesystem::exists(path.string() + "-wal");
  auto state = std::make_unique<State>(
      path, is_running ? Database::Access::kReadOnly : Database::Access::kFrozen);
  check_readable(state->database);
  read_identity(state->database);
  return Storage(std::move(state));
}

void Storage::append(std::span<const Event> events,
                     std::span<const Trial> new_trials,
                     std::span<const Replicate> replicates) {
  const std::lock_guard lock(state_->mutex);
  Transaction transaction(state_->database);
  for (const Trial& trial : new_trials) {
    insert_trial(state_->database, trial);
    if (trial.outcome) {
      insert_outcome(state_->database, trial.kind, trial.number, *trial.outcome);
    }
  }
  insert_replicates(state_->database, replicates);
  for (const Event& event : events) {
    insert_event(state_->database, event);
  }
  transaction.commit();
}

void Storage::put_trial(const Trial& trial) {
  const std::lock_guard lock(state_->mutex);
  Transaction transaction(state_->database);
  insert_trial(state_->database, trial);
  if (trial.outcome) {
    insert_outcome(state_->database, trial.kind, trial.number, *trial.outcome);
  } else {
    delete_outcome(state_->database, trial.kind, trial.number);
  }
  transaction.commit();
}

void Storage::record(TrialKind kind,
                     int number,
                     const Outcome& outcome,
                     std::span<const Replicate> replicates) {
  const std::lock_guard lock(state_->mutex);
  Transaction transaction(state_->database);
  insert_outcome(state_->database, kind, number, outcome);
  insert_replicates(state_->database, replicates);
  transaction.commit();
}

void Storage::record(std::span<const Replicate> replicates) {
  const std::lock_guard lock(state_->mutex);
  Transaction transaction(state_->database);
  insert_replicates(state_->database, replicates);
  transaction.commit();
}

void Storage::record_missing(std::span<const Replicate> replicates) {
  if (replicates.empty()) {
    return;
  }
  const std::lock_guard lock(state_->mutex);
  Transaction transaction(state_->database);
  for (const Replicate& replicate : replicates) {
    if (!has_replicate(state_->database, replicate)) {
      insert_replicates(state_->database, {&replicate, 1});
    }
  }
  transaction.commit();
}

void Storage::begin_epoch(const Event& event) {
  const std::lock_guard lock(state_->mutex);
  Transaction transaction(state_->database);
  delete_outcomes(state_->database, TrialKind::kSearch);
  insert_event(state_->database, event);
  transaction.commit();
}

void Storage::become(const StudyIdentity& identity,
                     const std::vector<Point>& points,
                     const Event& event) {
  const std::lock_guard lock(state_->mutex);
  Transaction transaction(state_->database);
  for (std::size_t i = 0; i < points.size(); ++i) {
    replace_point(state_->database, TrialKind::kSearch, static_cast<int>(i) + 1, points[i]);
  }
  Statement(state_->database, "UPDATE study SET config_hash = ?, config_text = ?")
      .bind(std::string_view(identity.config_hash))
      .bind(std::string_view(identity.config_text))
      .run();
  insert_event(state_->database, event);
  transaction.commit();
}

void Storage::set_session_seconds(double seconds) {
  const std::lock_guard lock(state_->mutex);
  Statement(state_->database, "UPDATE session SET seconds = ? WHERE number = ?")
      .bind(seconds)
      .bind(state_->session)
      .run();
}

double Storage::total_seconds() const {
  const std::lock_guard lock(state_->mutex);
  Statement sum(state_->database, "SELECT total(seconds) FROM session");
  return sum.step() ? sum.real(0) : 0.0;
}

StudyIdentity Storage::identity() const {
  const std::lock_guard lock(state_->mutex);
  return read_identity(state_->database);
}

std::vector<Event> Storage::events() const {
  const std::lock_guard lock(state_->mutex);
  std::vector<Event> events;
  const bool has_objectives =
      state_->database.integer("PRAGMA user_version") >= kFirstSchemaWithObjectives;
  Statement row(state_->database,
                has_objectives
                    ? "SELECT kind, trial, value, text, objectives FROM event ORDER BY seq"
                    : "SELECT kind, trial, value, text, NULL FROM event ORDER BY seq");
  while (row.step()) {
    events.push_back(
        {.kind = value_of<EventKind>(row.text(0), kEventKinds, state_->database.path()),
         .trial = static_cast<int>(row.integer(1)),
         .value = row.real(2),
         .text = row.text(3),
         .objectives = row.is_null(4) ? std::vector<double>{} : row.doubles(4)});
  }
  return events;
}

std::vector<Trial> Storage::trials(TrialKind kind) const {
  const std::lock_guard lock(state_->mutex);
  return read_trials(state_->database, kind);
}

std::vector<Replicate> Storage::replicates(TrialKind kind) const {
  const std::lock_guard lock(state_->mutex);
  return read_replicates(state_->database, kind);
}

}  // namespace glint
