// SPDX-License-Identifier: GPL-3.0-or-later
//
// Searches whose space is widened after they have begun: outcomes stay, and the algorithm begins
// anew with all designs so far; also before and after an epoch in which they are evaluated again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/optimizer/search/searching.h"

namespace glint::test {
namespace {

/// The minimum lies beyond the narrow space. Wrong until an epoch has withdrawn all outcomes.
Outcome loss_beyond(const Point& point, bool is_wrong) {
  double sum = 0.0;
  for (const double x : point) {
    sum += (x - 1.3) * (x - 1.3) + (is_wrong ? 0.2 * std::sin(40.0 * x) : 0.0);
  }
  return {.scores = {{"loss", sum}}};
}

/// One call of a program: up to which evaluation, and what it does before.
struct Part {
  int evaluations = 0;
  bool is_wide = false;
  int reviewed_at = 1000;  ///< told designs with which outcomes turn out to be wrong, once
  int stall = 0;
  double wall_clock_s = 0.0;
};

class Program {
 public:
  Program(const TemporaryFolder& folder, std::string algorithm, bool verifies = false)
      : folder_(folder), algorithm_(std::move(algorithm)), verifies_(verifies) {}

  /// @param abort_at  the evaluation that is cut short, counted from the program's begin; 0: none
  SearchResult run(const Part& part, int abort_at = 0) {
    Storage storage = Storage::open(folder_ / "s.sqlite", identity(part.is_wide ? "wide" : "abc"));
    bool is_wrong = std::ranges::none_of(storage.events(), [](const Event& event) {
      return event.kind == EventKind::kEpoch && event.trial > 0;
    });
    SearchTask task = {.space = part.is_wide ? box(3, -0.5, 2.0) : box(3, 0.0, 1.0),
                       .settings = {.algorithm = algorithm_, .batch = 2},
                       .goal = {.objective = {.name = "loss", .is_maximised = false}},
                       .budget = {.evaluations = part.evaluations,
                                  .wall_clock_s = part.wall_clock_s,
                                  .stall = part.stall},
                       .start_points = start_points,
                       .verify_replay = verifies_};
    task.review = [&](std::span<const Trial> told, TimeLeft) -> std::optional<Event> {
      if (!is_wrong || static_cast<int>(told.size()) < part.reviewed_at) {
        return std::nullopt;
      }
      is_wrong = false;
      return Event{.kind = EventKind::kEpoch, .trial = 3, .text = "wrong"};
    };
    std::atomic<int> interrupt = 0;
    int done = 0;
    const auto evaluate = [&](const Point& point, int) {
      if (++done == abort_at) {
        interrupt = 2;
        throw EvaluationAborted();
      }
      ++calls;
      return loss_beyond(point, is_wrong);
    };
    return run_search(task, storage, evaluate, &interrupt);
  }

  /// To the end, however often it is cut short.
  void run_in_pieces(const Part& part, int first) {
    SearchResult result = run(part, first);
    for (int next = 3; result.termination == Termination::kInterrupted; next += 5) {
      result = run(part, next);
    }
    EXPECT_EQ(result.evaluations, part.evaluations);
  }

  void widen() const {
    Storage storage = Storage::open(folder_ / "s.sqlite", identity("abc"));
    std::vector<Point> points;
    for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
      points.push_back(trial.point);
    }
    storage.become(identity("wide"), points, {.kind = EventKind::kEpoch, .text = "wider"});
  }

  int calls = 0;
  std::vector<Point> start_points;

 private:
  const TemporaryFolder& folder_;
  std::string algorithm_;
  bool verifies_;
};

std::vector<Trial> trials_in(const TemporaryFolder& folder) {
  return Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch);
}

TEST(SpaceEpoch, OutcomesStayAndTheSearchGoesOnBeyond) {
  for (const char* algorithm : {"gp", "bobyqa"}) {
    const TemporaryFolder folder;
    Program program(folder, algorithm);
    const double narrow = program.run({.evaluations = 20}).best->outcome->scores.at("loss");
    const std::vector<Trial> before = trials_in(folder);
    program.widen();
    EXPECT_THROW(Storage::open(folder / "s.sqlite", identity("abc")), ConfigError);
    const SearchResult result = program.run({.evaluations = 50, .is_wide = true});
    EXPECT_EQ(program.calls, 50) << "none is evaluated again";
    EXPECT_EQ(result.evaluations, 50);
    const std::vector<Trial> after = trials_in(folder);
    for (std::size_t k = 0; k < 20; ++k) {
      EXPECT_EQ(after[k].point, before[k].point);
      EXPECT_EQ(after[k].outcome->scores, before[k].outcome->scores);
    }
    EXPECT_LT(result.best->outcome->scores.at("loss"), 0.5 * narrow) << algorithm;
    EXPECT_GT(*std::ranges::max_element(result.best->point), 1.0) << algorithm;
  }
}

// The designs that the epoch begins with are told once more. They are no search without progress.
TEST(SpaceEpoch, ARunThatEndedByItsStallSearchesTheWiderSpace) {
  for (const char* algorithm : {"random", "sobol"}) {
    const TemporaryFolder folder;
    Program program(folder, algorithm);
    const SearchResult narrow = program.run({.evaluations = 300, .stall = 6});
    ASSERT_EQ(narrow.termination, Termination::kStall) << algorithm;
    program.widen();
    const SearchResult wide = program.run({.evaluations = 300, .is_wide = true, .stall = 6});
    EXPECT_GE(wide.evaluations, narrow.evaluations + 6) << algorithm;
  }
}

// A run that time has ended keeps its answer in the wider space.
TEST(SpaceEpoch, OutOfTimeItTellsAllThatItBeginsWith) {
  const TemporaryFolder folder;
  Program program(folder, "bobyqa");
  const SearchResult narrow = program.run({.evaluations = 20});
  Storage::open(folder / "s.sqlite", identity("abc")).set_session_seconds(3600.0);
  program.widen();
  const SearchResult wide = program.run({.evaluations = 50, .is_wide = true, .wall_clock_s = 60.0});
  EXPECT_EQ(wide.termination, Termination::kWallClock);
  EXPECT_EQ(program.calls, 20);
  ASSERT_TRUE(wide.best);
  EXPECT_EQ(wide.best->number, narrow.best->number);
}

// The budget ended before all of them were asked.
TEST(SpaceEpoch, StartPointsThatWereNotAskedYetAreAskedInTheWiderSpace) {
  const TemporaryFolder folder;
  Program program(folder, "random");
  for (const double x : {0.1, 0.2, 0.3, 0.4, 0.5}) {
    program.start_points.push_back({x, x, x});
  }
  program.run({.evaluations = 2});
  ASSERT_EQ(trials_in(folder).size(), 2U);
  program.widen();
  program.run({.evaluations = 6, .is_wide = true});
  const std::vector<Trial> after = trials_in(folder);
  ASSERT_GE(after.size(), 6U);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(after[k].point, program.start_points[k]) << k;
  }
  EXPECT_EQ(std::ranges::count(after, program.start_points[0], &Trial::point), 1);
}

/// A space epoch before and after one that withdraws all outcomes, cut short anywhere.
TEST(SpaceEpoch, CutShortAnywhereItComesToTheSameInBothOrders) {
  const std::vector<std::vector<Part>> orders = {
      {{.evaluations = 16, .reviewed_at = 24},
       {.evaluations = 40, .is_wide = true, .reviewed_at = 24}},
      {{.evaluations = 26, .reviewed_at = 14},
       {.evaluations = 40, .is_wide = true, .reviewed_at = 14}}};
  for (const char* algorithm : {"gp", "bobyqa", "cmaes", "random"}) {
    for (const std::vector<Part>& parts : orders) {
      const TemporaryFolder whole;
      Program program(whole, algorithm);
      program.run(parts[0]);
      program.widen();
      program.run(parts[1]);
      const std::vector<Event> events = Storage::read(whole / "s.sqlite").events();
      EXPECT_EQ(std::ranges::count(events, EventKind::kEpoch, &Event::kind), 2) << algorithm;
      for (const bool verifies : {false, true}) {
        for (const int first : {2, 9, 15, 23}) {
          const TemporaryFolder cut;
          Program pieces(cut, algorithm, verifies);
          pieces.run_in_pieces(parts[0], first);
          pieces.widen();
          pieces.run_in_pieces(parts[1], first);
          EXPECT_EQ(events_and_points(cut), events_and_points(whole)) << algorithm << first;
        }
      }
    }
  }
}

}  // namespace
}  // namespace glint::test
