// SPDX-License-Identifier: GPL-3.0-or-later
//
// Searches that keep each outcome under a label: when it is made, once, and whatever cut them
// short.
#include "optimizer/search/search.h"

#include <algorithm>
#include <atomic>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "optimizer/storage/sqlite.h"
#include "tests/optimizer/search/searching.h"

namespace glint {
namespace {

constexpr int kLabelledEvaluations = 12;
constexpr int kInFirstRung = 6;
constexpr int kFailsOnItsOwn = 4;  ///< number of a trial

struct LabelledSearch {
  int abort_at = 0;        ///< the evaluation that is cut short, counted in this process; 0: none
  bool has_epoch = false;  ///< all is evaluated again after kInFirstRung trials, and is worse by 10
  bool has_labels = true;
};

void search_labelled(const TemporaryFolder& folder, const LabelledSearch& how) {
  Storage storage = Storage::open(folder / "s.sqlite", test::identity());
  const std::vector<Event> events = storage.events();
  auto epoch = std::ranges::count(events, EventKind::kEpoch, &Event::kind);
  SearchTask task = {.space = test::box(2, 0, 1),
                     .settings = {.algorithm = "random", .batch = 2},
                     .goal = {.objective = {.name = "loss", .is_maximised = false}},
                     .budget = {.evaluations = kLabelledEvaluations}};
  if (how.has_epoch) {
    task.review = [&](std::span<const Trial> told, TimeLeft) -> std::optional<Event> {
      if (epoch > 0 || told.size() < kInFirstRung) {
        return std::nullopt;
      }
      ++epoch;
      return Event{.kind = EventKind::kEpoch, .trial = 1};
    };
  }
  if (how.has_labels) {
    task.label = [&](const Point& point) {
      return OutcomeLabel{
          .rung = fmt::format("rung {}{}", epoch, point[0] < 0.5 ? "" : " of right"), .seed = 7};
    };
  }
  std::atomic<int> interrupt = 0;
  int calls = 0;
  const auto evaluate = [&](const Point& point, int trial) -> Outcome {
    if (++calls == how.abort_at) {
      interrupt = 2;
      throw EvaluationAborted();
    }
    if (trial == kFailsOnItsOwn) {
      throw Error("no light");
    }
    return {.scores = {{"loss", point[0] + 10.0 * static_cast<double>(epoch)}}};
  };
  run_search(task, storage, evaluate, &interrupt);
}

std::vector<Replicate> labelled_in(const TemporaryFolder& folder) {
  return Storage::read(folder / "s.sqlite").replicates(TrialKind::kSearch);
}

/// Everything but times.
std::string labelled_text(const TemporaryFolder& folder) {
  std::string text;
  for (const Replicate& one : labelled_in(folder)) {
    const Outcome& outcome = one.outcome;
    text += fmt::format("{} {} {} {} ", one.number, one.rung, one.replicate, one.seed);
    text += outcome.is_failed ? outcome.message + "\n"
                              : fmt::format("{:a}\n", outcome.scores.at("loss"));
  }
  return text;
}

TEST(LabelledOutcomes, AreKeptWhenTheyAreMade) {
  const TemporaryFolder folder;
  search_labelled(folder, {.abort_at = 6});
  const std::vector<Replicate> kept = labelled_in(folder);
  const std::vector<Trial> trials = Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch);
  ASSERT_EQ(kept.size(), 5U) << "the sixth was in flight";
  for (std::size_t i = 0; i < kept.size(); ++i) {
    EXPECT_EQ(kept[i].number, static_cast<int>(i) + 1);
    EXPECT_EQ(kept[i].rung, trials[i].point[0] < 0.5 ? "rung 0" : "rung 0 of right");
    EXPECT_EQ(kept[i].replicate, 0);
    EXPECT_EQ(kept[i].seed, 7U);
    EXPECT_EQ(kept[i].outcome.scores, trials[i].outcome->scores);
    EXPECT_EQ(kept[i].outcome.message, kept[i].number == kFailsOnItsOwn ? "no light" : "");
  }
}

TEST(LabelledOutcomes, StayWhereAnEpochWithdrawsThem) {
  const TemporaryFolder folder;
  search_labelled(folder, {.has_epoch = true});
  int withdrawn = 0;
  for (const Replicate& one : labelled_in(folder)) {
    const bool is_first = one.rung.starts_with("rung 0");
    withdrawn += is_first ? 1 : 0;
    if (!one.outcome.is_failed) {
      EXPECT_EQ(one.outcome.scores.at("loss") < 10.0, is_first);
    }
  }
  EXPECT_EQ(withdrawn, kInFirstRung);
  EXPECT_EQ(static_cast<int>(labelled_in(folder).size()), kInFirstRung + kLabelledEvaluations);
}

TEST(LabelledOutcomes, AreTheSameWhereverTheSearchIsCutShort) {
  const TemporaryFolder whole;
  search_labelled(whole, {.has_epoch = true});
  for (const int abort_at : {4, 7, 13, kInFirstRung + kLabelledEvaluations}) {
    const TemporaryFolder folder;
    search_labelled(folder, {.abort_at = abort_at, .has_epoch = true});
    EXPECT_EQ(static_cast<int>(labelled_in(folder).size()), abort_at - 1);
    search_labelled(folder, {.has_epoch = true});
    EXPECT_EQ(labelled_text(folder), labelled_text(whole)) << abort_at;
  }
}

/// Lets the search of a folder go on, and compares it with a whole one.
void expect_completed(const TemporaryFolder& folder, const TemporaryFolder& whole) {
  ASSERT_NE(labelled_text(folder), labelled_text(whole));
  search_labelled(folder, {});
  EXPECT_EQ(labelled_text(folder), labelled_text(whole));
}

TEST(LabelledOutcomes, OfProgramsBeforeAreAddedWhenTheSearchGoesOn) {
  const TemporaryFolder whole;
  search_labelled(whole, {});
  for (const int abort_at : {0, 8}) {  // ended, and cut short
    const TemporaryFolder folder;
    search_labelled(folder, {.abort_at = abort_at, .has_labels = false});
    EXPECT_TRUE(labelled_in(folder).empty());
    expect_completed(folder, whole);
  }
  const auto change = [](const TemporaryFolder& folder, const char* sql) {
    Database(folder / "s.sqlite", Database::Access::kReadWrite).run(sql);
  };
  const TemporaryFolder partly;
  search_labelled(partly, {});
  change(partly,
         "DELETE FROM replicate WHERE number > 3; DELETE FROM replicate_value WHERE number > 3");
  expect_completed(partly, whole);
  const TemporaryFolder of_schema_6;
  search_labelled(of_schema_6, {.abort_at = 8});
  change(of_schema_6, "DROP TABLE replicate; DROP TABLE replicate_value; PRAGMA user_version = 6");
  expect_completed(of_schema_6, whole);
}

}  // namespace
}  // namespace glint
