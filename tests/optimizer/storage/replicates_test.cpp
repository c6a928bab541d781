// SPDX-License-Identifier: GPL-3.0-or-later
//
// More than one outcome of a trial.
#include <gtest/gtest.h>

#include "optimizer/storage/sqlite.h"
#include "tests/optimizer/storage/some_trials.h"

namespace glint {
namespace {

TEST(Replicates, HoldsAnOutcomeForEachTrialRungReplicateAndSeed) {
  const TemporaryFolder folder;
  const auto made = [](int number, const char* rung, int replicate, std::uint64_t seed, double h) {
    return Replicate{.number = number,
                     .rung = rung,
                     .replicate = replicate,
                     .seed = seed,
                     .outcome = {.scores = {{"h", h}}, .seconds = 0.25}};
  };
  {
    Storage storage = Storage::open(folder / "s.sqlite", test::identity());
    test::write_some_trials(storage, 2);
    storage.record(std::vector<Replicate>{made(2, "fine", 0, 1, 0.1),
                                          made(1, "fine", 1, 18446744073709551615U, 0.2),
                                          made(1, "fine", 0, 1, 0.3),
                                          made(1, "coarse", 0, 1, 0.4)});
    storage.record(std::vector<Replicate>{made(1, "fine", 0, 1, 0.35)});  // once more
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
