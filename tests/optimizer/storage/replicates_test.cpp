// SPDX-License-Identifier: GPL-3.0-or-later
//
// More than one outcome of a trial.
#include <gtest/gtest.h>

#include "optimizer/storage/sqlite.h"
#include "tests/optimizer/storage/some_trials.h"

namespace glint {
namespace {

Replicate made_replicate(
    int number, const char* rung, int replicate, std::uint64_t seed, double h) {
  return labelled({.rung = rung, .replicate = replicate, .seed = seed},
                  TrialKind::kSearch,
                  number,
                  {.scores = {{"h", h}}, .seconds = 0.25});
}

TEST(Replicates, HoldsAnOutcomeForEachTrialRungReplicateAndSeed) {
  const TemporaryFolder folder;
  {
    Storage storage = Storage::open(folder / "s.sqlite", test::identity());
    test::write_some_trials(storage, 2);
    storage.record(std::vector<Replicate>{made_replicate(2, "fine", 0, 1, 0.1),
                                          made_replicate(1, "fine", 1, 18446744073709551615U, 0.2),
                                          made_replicate(1, "fine", 0, 1, 0.3),
                                          made_replicate(1, "coarse", 0, 1, 0.4)});
    storage.record(std::vector<Replicate>{made_replicate(1, "fine", 0, 1, 0.35)});  // once more
    storage.record(std::vector<Replicate>{
        {.number = 2, .rung = "coarse", .outcome = {.is_failed = true, .message = "no light"}}});
  }
  const Storage storage = Storage::read(folder / "s.sqlite");
  const std::vector<Replicate> read = storage.replicates(TrialKind::kSearch);
  ASSERT_EQ(read.size(), 5U);
  EXPECT_EQ(read[0].rung, "coarse");
  EXPECT_EQ(read[0].outcome.scores.at("h"), 0.4);
  EXPECT_EQ(read[1].outcome.scores.at("h"), 0.35);
  EXPECT_EQ(read[1].outcome.seconds, 0.25);
  EXPECT_EQ(read[2].replicate, 1);
  EXPECT_EQ(read[2].seed, 18446744073709551615U);
  EXPECT_TRUE(read[3].outcome.is_failed);
  EXPECT_EQ(read[3].outcome.message, "no light");
  EXPECT_EQ(read[4].number, 2);
  EXPECT_TRUE(storage.replicates(TrialKind::kPart).empty());
  EXPECT_EQ(storage.trials(TrialKind::kSearch)[0].outcome->scores.at("h"), 1.0) << "the search's";
}

TEST(Replicates, ThoseThatAreMissingAreAddedAndTheOthersStay) {
  const TemporaryFolder folder;
  Storage storage = Storage::open(folder / "s.sqlite", test::identity());
  test::write_some_trials(storage, 2);
  storage.record(std::vector<Replicate>{made_replicate(1, "fine", 0, 1, 0.1)});
  storage.record_missing(std::vector<Replicate>{made_replicate(1, "fine", 0, 1, 0.2),
                                                made_replicate(1, "fine", 0, 2, 0.3),
                                                made_replicate(1, "coarse", 0, 1, 0.4),
                                                made_replicate(2, "fine", 0, 1, 0.5),
                                                made_replicate(2, "fine", 1, 1, 0.6)});
  const std::vector<Replicate> read = storage.replicates(TrialKind::kSearch);
  ASSERT_EQ(read.size(), 5U);
  EXPECT_EQ(read[0].outcome.scores.at("h"), 0.4);
  EXPECT_EQ(read[1].outcome.scores.at("h"), 0.1) << "was there";
  EXPECT_EQ(read[2].outcome.scores.at("h"), 0.3);
  EXPECT_EQ(read[3].outcome.scores.at("h"), 0.5);
  EXPECT_EQ(read[4].outcome.scores.at("h"), 0.6);
}

TEST(Replicates, AreRecordedWithTheirTrialOrNotAtAll) {
  const TemporaryFolder folder;
  {
    Storage storage = Storage::open(folder / "s.sqlite", test::identity());
    test::write_some_trials(storage, 1);
  }
  Database(folder / "s.sqlite", Database::Access::kReadWrite)
      .run(
          "CREATE TRIGGER full BEFORE INSERT ON replicate WHEN NEW.rung = 'full' "
          "BEGIN SELECT RAISE(ABORT, 'no space'); END");
  Storage storage = Storage::open(folder / "s.sqlite", test::identity());
  const std::vector<Replicate> one = {made_replicate(1, "fine", 0, 1, 9.0)};
  const std::vector<Replicate> lost = {made_replicate(1, "full", 0, 1, 9.0)};
  const Outcome outcome = {.scores = {{"h", 9.0}}};
  const std::vector<Trial> raced = {
      {.kind = TrialKind::kReplicate, .number = 1, .name = "half", .outcome = outcome}};
  EXPECT_THROW(storage.record(TrialKind::kSearch, 1, outcome, lost), IoError);
  EXPECT_THROW(storage.append({}, raced, lost), IoError);
  EXPECT_EQ(storage.trials(TrialKind::kSearch)[0].outcome->scores.at("h"), 1.0);
  EXPECT_TRUE(storage.trials(TrialKind::kReplicate).empty());
  storage.record(TrialKind::kSearch, 1, outcome, one);
  storage.append({}, raced, std::vector<Replicate>{made_replicate(1, "fine", 1, 1, 8.0)});
  EXPECT_EQ(storage.trials(TrialKind::kSearch)[0].outcome->scores.at("h"), 9.0);
  EXPECT_EQ(storage.trials(TrialKind::kReplicate).size(), 1U);
  EXPECT_EQ(storage.replicates(TrialKind::kSearch).size(), 2U);
}

TEST(Replicates, Schema6IsReadAsItIsAndUpgradedWhenOpened) {
  const TemporaryFolder folder;
  {
    Storage storage = Storage::open(folder / "s.sqlite", test::identity());
    test::write_some_trials(storage, 3);
  }
  Database(folder / "s.sqlite", Database::Access::kReadWrite)
      .run("DROP TABLE replicate; DROP TABLE replicate_value; PRAGMA user_version = 6");
  EXPECT_EQ(Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch).size(), 3U);
  EXPECT_TRUE(Storage::read(folder / "s.sqlite").replicates(TrialKind::kSearch).empty());
  {
    Storage storage = Storage::open(folder / "s.sqlite", test::identity());
    EXPECT_EQ(storage.events().size(), 6U);
    storage.record(std::vector<Replicate>{{.number = 1, .rung = "fine"}});
  }
  EXPECT_EQ(Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch).size(), 3U);
  EXPECT_EQ(Storage::read(folder / "s.sqlite").replicates(TrialKind::kSearch).size(), 1U);
}

}  // namespace
}  // namespace glint
