// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/storage/storage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "core/file.h"
#include "optimizer/storage/sqlite.h"
#include "tests/optimizer/algorithm/problems.h"
#include "tests/optimizer/storage/some_trials.h"

namespace glint {
namespace {

using test::identity;
using test::open_error;
using test::write_some_trials;
using testing::HasSubstr;

TEST(Storage, GivesBackNumbersBitForBit) {
  const TemporaryFolder folder;
  std::vector<Trial> written;
  std::vector<Event> events;
  {
    Storage storage = Storage::open(folder / "s.sqlite", identity());
    for (int n = 1; n <= 1000; ++n) {
      Rng rng(4, Stream::kTest, static_cast<std::uint64_t>(n));
      const double scale = std::pow(10.0, rng.uniform(-300, 300));
      written.push_back(
          {.number = n,
           .point = {scale * rng.normal(), rng.uniform(), 3.0},
           .outcome = Outcome{
               .scores = {{"a", rng.normal() * scale}, {"b", 2.0}},
               .gradients = {{"a", {rng.normal() / scale, rng.normal(), 1.0}}, {"b", {scale}}}}});
      events.push_back({.kind = EventKind::kTell, .trial = n, .value = rng.normal() / scale});
    }
    // Most with their outcomes, one of ten before it, and one of ten never evaluated.
    std::vector<Trial> appended = written;
    for (Trial& trial : appended) {
      if (trial.number % 10 < 2) {
        trial.outcome.reset();
      }
    }
    storage.append(events, appended);
    for (const Trial& trial : written) {
      if (trial.number % 10 == 0) {
        storage.record(TrialKind::kSearch, trial.number, *trial.outcome);
      }
    }
  }
  const Storage storage = Storage::read(folder / "s.sqlite");
  const std::vector<Trial> read = storage.trials(TrialKind::kSearch);
  const std::vector<Event> read_events = storage.events();
  ASSERT_EQ(read.size(), written.size());
  ASSERT_EQ(read_events.size(), events.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    ASSERT_EQ(read[i].point, written[i].point);
    ASSERT_EQ(read_events[i].value, events[i].value);
    ASSERT_EQ(read[i].outcome.has_value(), read[i].number % 10 != 1);
    if (read[i].outcome) {
      ASSERT_EQ(read[i].outcome->scores, written[i].outcome->scores);
      ASSERT_EQ(read[i].outcome->gradients, written[i].outcome->gradients);
    }
  }
}

TEST(Storage, KeepsNaNInfinityTextsAndFailures) {
  const TemporaryFolder folder;
  const double infinity = std::numeric_limits<double>::infinity();
  {
    Storage storage = Storage::open(folder / "s.sqlite", identity());
    storage.put_trial({.kind = TrialKind::kPart,
                       .number = 1,
                       .name = "semi\"cylinder'",
                       .point = {1.0},
                       .outcome = Outcome{.scores = {{"nan", std::nan("")}, {"inf", -infinity}},
                                          .gradients = {{"inf", {1.5, std::nan(""), infinity}}}}});
    storage.put_trial({.kind = TrialKind::kPart,
                       .number = 2,
                       .point = {},
                       .outcome = Outcome{.is_failed = true, .message = "slot wider than tunnel"}});
  }
  const Storage storage = Storage::read(folder / "s.sqlite");
  const std::vector<Trial> parts = storage.trials(TrialKind::kPart);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].name, "semi\"cylinder'");
  EXPECT_TRUE(std::isnan(parts[0].outcome->scores.at("nan")));
  EXPECT_EQ(parts[0].outcome->scores.at("inf"), -infinity);
  const std::vector<double> gradient = parts[0].outcome->gradients.at("inf");
  ASSERT_EQ(gradient.size(), 3U);
  EXPECT_EQ(gradient[0], 1.5);
  EXPECT_TRUE(std::isnan(gradient[1]));
  EXPECT_EQ(gradient[2], infinity);
  EXPECT_TRUE(parts[1].outcome->is_failed);
  EXPECT_EQ(parts[1].outcome->message, "slot wider than tunnel");
  EXPECT_TRUE(storage.trials(TrialKind::kSearch).empty());
}

TEST(Storage, KeepsRemarksAsValues) {
  const TemporaryFolder folder;
  Storage storage = Storage::open(folder / "s.sqlite", identity());
  const std::vector<Remark> remarks = {{.count = 71, .text = "pixels are held"},
                                       {.count = {}, .text = "3 lights | 4 walls are held"},
                                       {.count = 0, .text = ""}};
  Trial trial = {.number = 1, .point = {1.0}, .outcome = Outcome{.remarks = remarks}};
  storage.put_trial(trial);
  EXPECT_EQ(storage.trials(TrialKind::kSearch).at(0).outcome->remarks, remarks);
  trial.outcome = Outcome{};
  storage.put_trial(trial);
  EXPECT_EQ(storage.trials(TrialKind::kSearch).at(0).outcome->remarks.size(), 0U);
}

TEST(Storage, PutTrialReplacesTheFormerOne) {
  const TemporaryFolder folder;
  Storage storage = Storage::open(folder / "s.sqlite", identity());
  Trial trial = {.kind = TrialKind::kPart,
                 .number = 1,
                 .outcome = Outcome{.scores = {{"a", 1.0}}, .gradients = {{"a", {1.0, 2.0}}}}};
  storage.put_trial(trial);
  trial.outcome = Outcome{.scores = {{"b", 2.0}}};
  storage.put_trial(trial);
  const std::vector<Trial> trials = storage.trials(TrialKind::kPart);
  ASSERT_EQ(trials.size(), 1U);
  EXPECT_EQ(trials[0].outcome->scores, (Scores{{"b", 2.0}}));
  EXPECT_TRUE(trials[0].outcome->gradients.empty());
}

StudyIdentity identity_in(const std::filesystem::path& path) {
  Database database(path, Database::Access::kReadOnly);
  Statement row(database, "SELECT config_hash, config_text, code_version, seed FROM study");
  EXPECT_TRUE(row.step());
  return {.config_hash = row.text(0),
          .config_text = row.text(1),
          .code_version = row.text(2),
          .seed = std::bit_cast<std::uint64_t>(row.integer(3))};
}

TEST(Storage, RemembersTheStudyAndItsSessions) {
  const TemporaryFolder folder;
  StudyIdentity study = identity();
  study.seed = 0xFFFFFFFFFFFFFFFFULL;
  for (int i = 0; i < 3; ++i) {
    Storage storage = Storage::open(folder / "s.sqlite", study);
    EXPECT_EQ(identity_in(folder / "s.sqlite").seed, study.seed);
    EXPECT_EQ(storage.identity().seed, study.seed);
    EXPECT_EQ(storage.identity().config_text, "[part]\n");
    EXPECT_EQ(identity_in(folder / "s.sqlite").config_text, "[part]\n");
    EXPECT_DOUBLE_EQ(storage.total_seconds(), 1.5 * i);
    storage.set_session_seconds(1.0);
    storage.set_session_seconds(1.5);
  }
}

TEST(Storage, LeavesNothingButTheDatabaseWhenClosed) {
  const TemporaryFolder folder;
  { Storage::open(folder / "s.sqlite", identity()); }
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "")) {
    EXPECT_EQ(entry.path().filename(), "s.sqlite");
    ++files;
  }
  EXPECT_EQ(files, 1);
}

TEST(Storage, RefusesAnotherStudy) {
  const TemporaryFolder folder;
  { Storage::open(folder / "s.sqlite", identity("abc")); }
  EXPECT_THAT(open_error(folder / "s.sqlite", "xyz"), HasSubstr("ConfigError"));
  EXPECT_THAT(open_error(folder / "s.sqlite", "xyz"), HasSubstr("holds another study"));
  EXPECT_EQ(open_error(folder / "s.sqlite", "abc"), "");
}

TEST(Storage, RefusesWhatIsNoDatabase) {
  const TemporaryFolder folder;
  write_file(folder / "text", std::string(5000, 'x'));
  EXPECT_THAT(open_error(folder / "text"), HasSubstr("is not a study database"));
  write_file(folder / "short", "hello");
  EXPECT_THAT(open_error(folder / "short"), HasSubstr("IoError"));
  write_file(folder / "empty", "");
  EXPECT_THAT(open_error(folder / "empty"), HasSubstr("truncated"));
  EXPECT_THAT(open_error(folder / "no_folder" / "s.sqlite"), HasSubstr("No such file"));
  EXPECT_THROW(Storage::read(folder / "nothing"), IoError);
}

TEST(Storage, SaysThatAPathIsTooLong) {
  const TemporaryFolder folder;
  const std::string name(200, 'x');
  const std::filesystem::path deep = folder / name / name / name;
  make_folder(deep);
  EXPECT_THAT(open_error(deep / "s.sqlite"), HasSubstr("its path is longer than the 500 bytes"));
}

TEST(Storage, RefusesATruncatedDatabaseWhateverIsLeft) {
  const TemporaryFolder folder;
  {
    Storage storage = Storage::open(folder / "s.sqlite", identity());
    write_some_trials(storage, 200);
  }
  const std::string bytes = read_file(folder / "s.sqlite");
  ASSERT_GT(bytes.size(), 20000U);
  for (const std::size_t size : {std::size_t{50},
                                 std::size_t{100},
                                 std::size_t{2000},
                                 std::size_t{4096},
                                 std::size_t{10000},
                                 bytes.size() / 2,
                                 bytes.size() - 4096,
                                 bytes.size() - 1}) {
    write_file(folder / "cut", bytes.substr(0, size));
    EXPECT_THAT(open_error(folder / "cut"), HasSubstr("IoError")) << size;
    EXPECT_THROW(Storage::read(folder / "cut"), IoError) << size;
  }
}

TEST(Storage, RefusesADamagedPage) {
  const TemporaryFolder folder;
  {
    Storage storage = Storage::open(folder / "s.sqlite", identity());
    write_some_trials(storage, 200);
  }
  std::string bytes = read_file(folder / "s.sqlite");
  for (std::size_t i = 0; i < 4096; ++i) {
    bytes[bytes.size() / 2 / 4096 * 4096 + i] = static_cast<char>(i);
  }
  write_file(folder / "s.sqlite", bytes);
  EXPECT_THAT(open_error(folder / "s.sqlite"), HasSubstr("damaged"));
}

/// Byte 60 of the header is the user version, byte 68 the application id, both big-endian.
TEST(Storage, RefusesNewerSchemasAndOtherPrograms) {
  const TemporaryFolder folder;
  { Storage::open(folder / "s.sqlite", identity()); }
  const std::string bytes = read_file(folder / "s.sqlite");
  std::string newer = bytes;
  newer[63] = 9;
  write_file(folder / "newer", newer);
  EXPECT_THAT(open_error(folder / "newer"), HasSubstr("newer Glint (schema 9"));
  std::string other = bytes;
  other[68] = 0;
  write_file(folder / "other", other);
  EXPECT_THAT(open_error(folder / "other"), HasSubstr("another program"));
}

/// A database as an earlier schema made it: 1 had no table of gradients, 2 none of remarks, which
/// were a text in the message.
void write_schema(int schema, const std::filesystem::path& path, const StudyIdentity& study) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  const std::string sql = R"sql(
PRAGMA application_id = 1196183124;
CREATE TABLE study(
  id INTEGER PRIMARY KEY CHECK (id = 1),
  config_hash TEXT NOT NULL, config_text TEXT NOT NULL, code_version TEXT NOT NULL,
  seed INTEGER NOT NULL);
CREATE TABLE session(number INTEGER PRIMARY KEY, seconds REAL NOT NULL);
CREATE TABLE trial(
  kind TEXT NOT NULL, number INTEGER NOT NULL, name TEXT NOT NULL,
  point BLOB NOT NULL,
  PRIMARY KEY (kind, number)) WITHOUT ROWID;
CREATE TABLE evaluation(
  kind TEXT NOT NULL, number INTEGER NOT NULL,
  status TEXT NOT NULL CHECK (status IN ('done', 'failed')),
  message TEXT NOT NULL, seconds REAL NOT NULL,
  PRIMARY KEY (kind, number)) WITHOUT ROWID;
CREATE TABLE value(
  kind TEXT NOT NULL, number INTEGER NOT NULL, name TEXT NOT NULL,
  value REAL,
  PRIMARY KEY (kind, number, name)) WITHOUT ROWID;
CREATE TABLE event(
  seq INTEGER PRIMARY KEY, kind TEXT NOT NULL, trial INTEGER NOT NULL, value REAL,
  text TEXT NOT NULL);
INSERT INTO session(seconds) VALUES(2.5);
INSERT INTO trial VALUES('search', 1, '', X'000000000000E03F000000000000D03F');
INSERT INTO evaluation VALUES('search', 1, 'done', '', 0.5);
INSERT INTO value VALUES('search', 1, 'loss', 0.75);
INSERT INTO event(kind, trial, value, text) VALUES('ask', 1, 0.0, ''), ('tell', 1, 0.75, '');
INSERT INTO study VALUES(1, ')sql" +
                          study.config_hash + "', '" + study.config_text + "', 'old', 7);";
  const std::string of_schema_2 = R"sql(
CREATE TABLE gradient(
  kind TEXT NOT NULL, number INTEGER NOT NULL, score TEXT NOT NULL,
  variable INTEGER NOT NULL,
  value REAL,
  PRIMARY KEY (kind, number, score, variable)) WITHOUT ROWID;
INSERT INTO gradient VALUES('search', 1, 'loss', 0, 1.0), ('search', 1, 'loss', 1, 2.0);
UPDATE evaluation SET message = '71 pixels are held | the edge is held';)sql";
  const std::string all = sql + "PRAGMA user_version = " + std::to_string(schema) + ";" +
                          (schema < 2 ? "" : of_schema_2);
  EXPECT_EQ(sqlite3_exec(database, all.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
}

std::int64_t schema_of(const std::filesystem::path& path) {
  return static_cast<unsigned char>(read_file(path).at(63));
}

TEST(Storage, ReadsSchema1AsItIs) {
  const TemporaryFolder folder;
  write_schema(1, folder / "s.sqlite", identity());
  const std::string bytes = read_file(folder / "s.sqlite");
  {
    const Storage storage = Storage::read(folder / "s.sqlite");
    const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
    ASSERT_EQ(trials.size(), 1U);
    EXPECT_EQ(trials[0].point, (Point{0.5, 0.25}));
    EXPECT_EQ(trials[0].outcome->scores.at("loss"), 0.75);
    EXPECT_TRUE(trials[0].outcome->gradients.empty());
    EXPECT_EQ(storage.events().size(), 2U);
  }
  EXPECT_EQ(read_file(folder / "s.sqlite"), bytes);
}

TEST(Storage, UpgradesSchema1WhenOpenedAndKeepsWhatItHolds) {
  const TemporaryFolder folder;
  write_schema(1, folder / "s.sqlite", identity());
  EXPECT_THAT(open_error(folder / "s.sqlite", "xyz"), HasSubstr("holds another study"));
  EXPECT_EQ(schema_of(folder / "s.sqlite"), 1);
  const Outcome outcome = {.scores = {{"loss", 0.5}}, .gradients = {{"loss", {1.0, -0.1}}}};
  for (int i = 0; i < 2; ++i) {
    Storage storage = Storage::open(folder / "s.sqlite", identity());
    EXPECT_EQ(identity_in(folder / "s.sqlite").code_version, "old");
    EXPECT_DOUBLE_EQ(storage.total_seconds(), 2.5);
    EXPECT_EQ(storage.events().size(), 2U);
    storage.put_trial({.number = 2, .point = {1.0, 2.0}, .outcome = outcome});
  }
  EXPECT_EQ(schema_of(folder / "s.sqlite"), Storage::kSchema);
  const std::vector<Trial> trials = Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch);
  ASSERT_EQ(trials.size(), 2U);
  EXPECT_EQ(trials[0].outcome->scores.at("loss"), 0.75);
  EXPECT_TRUE(trials[0].outcome->gradients.empty());
  EXPECT_EQ(trials[1].outcome->gradients, outcome.gradients);
}

const std::vector<Remark> kOldRemarks = {{.count = 71, .text = "pixels are held"},
                                         {.count = {}, .text = "the edge is held"}};

TEST(Storage, ReadsTheRemarksOfSchema2FromTheMessage) {
  const TemporaryFolder folder;
  write_schema(2, folder / "s.sqlite", identity());
  const std::string bytes = read_file(folder / "s.sqlite");
  {
    const Storage storage = Storage::read(folder / "s.sqlite");
    const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
    ASSERT_EQ(trials.size(), 1U);
    EXPECT_EQ(trials[0].outcome->remarks, kOldRemarks);
    EXPECT_EQ(trials[0].outcome->message, "");
    EXPECT_EQ(trials[0].outcome->gradients.at("loss"), (std::vector<double>{1.0, 2.0}));
  }
  EXPECT_EQ(read_file(folder / "s.sqlite"), bytes);
}

/// Of a search by derivatives that schema 2 recorded the first trial is replayed, with its remarks.
TEST(Storage, ASearchBegunUnderSchema2GoesOnAndKeepsItsRemarks) {
  const TemporaryFolder folder;
  write_schema(2, folder / "s.sqlite", identity());
  const Remark remark = {.count = 5, .text = "pixels | lines are held"};
  {
    Storage storage = Storage::open(folder / "s.sqlite", identity());
    const SearchResult result =
        run_search({.space = test::box(2, 0, 1),
                    .settings = {.algorithm = "slsqp"},
                    .goal = {.objective = {.name = "loss", .is_maximised = false}},
                    .budget = {.evaluations = 4},
                    .start_points = {{0.5, 0.25}}},
                   storage,
                   [&](const Point& p, int) {
                     return Outcome{.scores = {{"loss", 0.25 + p[0] * p[0] + p[1]}},
                                    .remarks = {remark},
                                    .gradients = {{"loss", {2.0 * p[0], 1.0}}}};
                   });
    EXPECT_EQ(result.replayed, 1);
  }
  EXPECT_EQ(schema_of(folder / "s.sqlite"), Storage::kSchema);
  const std::vector<Trial> trials = Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch);
  ASSERT_GE(trials.size(), 2U);
  EXPECT_EQ(trials[0].outcome->remarks, kOldRemarks);
  EXPECT_EQ(trials[1].outcome->remarks, std::vector<Remark>{remark});
}

TEST(Storage, KeepsTheObjectivesOfEventsBitForBit) {
  const TemporaryFolder folder;
  const std::vector<double> objectives = {-0.1, 1e-300, 3.0};
  {
    Storage storage = Storage::open(folder / "s.sqlite", identity());
    storage.append(
        std::vector<Event>{{.kind = EventKind::kTell, .trial = 1, .value = 0.5},
                           {.kind = EventKind::kReference, .trial = 1, .objectives = objectives}});
  }
  const std::vector<Event> events = Storage::read(folder / "s.sqlite").events();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_TRUE(events[0].objectives.empty());
  EXPECT_EQ(events[1].kind, EventKind::kReference);
  EXPECT_EQ(events[1].objectives, objectives);
}

TEST(Storage, EventsOfEarlierSchemasHaveNoObjectivesAndTakeThemOnceUpgraded) {
  const TemporaryFolder folder;
  write_schema(2, folder / "s.sqlite", identity());
  for (const Event& event : Storage::read(folder / "s.sqlite").events()) {
    EXPECT_TRUE(event.objectives.empty());
  }
  {
    Storage storage = Storage::open(folder / "s.sqlite", identity());
    storage.append(std::vector<Event>{{.kind = EventKind::kReference, .objectives = {1.0, 2.0}}});
  }
  const std::vector<Event> events = Storage::read(folder / "s.sqlite").events();
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[1].value, 0.75);
  EXPECT_TRUE(events[1].objectives.empty());
  EXPECT_EQ(events[2].objectives, (std::vector<double>{1.0, 2.0}));
}

/// What schema 1 recorded is replayed: trial 1 is the start point that it was.
TEST(Storage, ASearchBegunUnderSchema1GoesOn) {
  const TemporaryFolder folder;
  write_schema(1, folder / "s.sqlite", identity());
  Storage storage = Storage::open(folder / "s.sqlite", identity());
  int calls = 0;
  const SearchResult result =
      run_search({.space = test::box(2, 0, 1),
                  .settings = {.algorithm = "bobyqa"},
                  .goal = {.objective = {.name = "loss", .is_maximised = false}},
                  .budget = {.evaluations = 20},
                  .start_points = {{0.5, 0.25}}},
                 storage,
                 [&calls](const Point& p, int) {
                   ++calls;
                   return Outcome{.scores = {{"loss", p[0] + 2.0 * p[1]}}};
                 });
  EXPECT_EQ(result.replayed, 1);
  EXPECT_EQ(calls, 19);
  EXPECT_EQ(result.evaluations, 20);
}

}  // namespace
}  // namespace glint
