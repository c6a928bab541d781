// SPDX-License-Identifier: GPL-3.0-or-later
//
// Searches whose scores turn out to be wrong while they go on: all of them are evaluated again, and
// the algorithm begins anew.
#include "optimizer/search/search.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/optimizer/algorithm/problems.h"
#include "tests/optimizer/search/searching.h"

namespace glint {
namespace {

constexpr int kEvaluations = 60;
constexpr int kReviewedAt = 25;

/// Wrong by an error that depends on the design, until an epoch has begun. As a reviewer does, it
/// finds out from the log how many have.
class RisingRung {
 public:
  explicit RisingRung(const Storage& storage)
      : rung_(static_cast<int>(
            std::ranges::count(storage.events(), EventKind::kEpoch, &Event::kind))) {}

  Outcome evaluate(const Point& point) {
    ++calls;
    double sum = 0.0;
    for (const double x : point) {
      sum += (x - 0.3) * (x - 0.3) + (rung_ == 0 ? 0.2 * std::sin(40.0 * x) : 0.0);
    }
    return {.scores = {{"loss", sum}, {"length", point[0]}}};
  }

  std::optional<Event> review(std::span<const Trial> told) {
    const bool is_wrong = rung_ == 0 && told.size() >= kReviewedAt;
    if (!is_wrong) {
      return std::nullopt;
    }
    ++rung_;
    return Event{.kind = EventKind::kEpoch, .trial = 3, .value = 1.0, .text = "wrong"};
  }

  int calls = 0;

 private:
  int rung_;
};

SearchTask task_of(const std::string& algorithm) {
  SearchTask task = {.space = test::box(3, 0, 1),
                     .settings = {.algorithm = algorithm, .batch = 2},
                     .goal = {.objective = {.name = "loss", .is_maximised = false}},
                     .budget = {.evaluations = kEvaluations}};
  if (algorithm == "sobol") {
    task.goal.more_objectives = {{.name = "length", .is_maximised = true}};
  }
  return task;
}

/// @param abort_at  the evaluation that is cut short, counted in this process; 0: none
SearchResult search_in_epochs(const TemporaryFolder& folder,
                              const std::string& algorithm,
                              int abort_at = 0,
                              int* calls = nullptr) {
  Storage storage = Storage::open(folder / "s.sqlite", test::identity());
  RisingRung rung(storage);
  std::atomic<int> interrupt = 0;
  SearchTask task = task_of(algorithm);
  task.review = [&](std::span<const Trial> told, TimeLeft) { return rung.review(told); };
  SearchResult result = run_search(
      task,
      storage,
      [&](const Point& point, int) {
        if (rung.calls + 1 == abort_at) {
          interrupt = 2;
          throw EvaluationAborted();
        }
        return rung.evaluate(point);
      },
      &interrupt);
  if (calls != nullptr) {
    *calls += rung.calls;
  }
  return result;
}

/// Everything but times.
std::string log_of(const TemporaryFolder& folder) {
  std::string text = test::events_and_points(folder);
  for (const Trial& trial : Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch)) {
    text += trial.outcome ? fmt::format("{:a}\n", trial.outcome->scores.at("loss")) : "-\n";
  }
  return text;
}

TEST(SearchEpoch, EvaluatesWhatWasAskedOnceMoreAndGoesOn) {
  const TemporaryFolder folder;
  int calls = 0;
  const SearchResult result = search_in_epochs(folder, "bobyqa", 0, &calls);
  EXPECT_EQ(result.termination, Termination::kEvaluations);
  EXPECT_EQ(result.evaluations, kEvaluations);
  EXPECT_EQ(calls, kEvaluations + kReviewedAt + 1) << "batches of two: 26 were wrong";
  const Storage storage = Storage::read(folder / "s.sqlite");
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    double sum = 0.0;
    for (const double x : trial.point) {
      sum += (x - 0.3) * (x - 0.3);
    }
    if (trial.outcome) {  // else asked in the last batch, beyond the budget
      EXPECT_EQ(trial.outcome->scores.at("loss"), sum) << "no wrong score is left";
    }
  }
  const std::vector<Event> events = storage.events();
  auto event = std::ranges::find(events, EventKind::kEpoch, &Event::kind);
  ASSERT_NE(event, events.end());
  EXPECT_EQ(event->text, "wrong");
  std::vector<int> asked;
  for (++event; event != events.end(); ++event) {
    if (event->kind == EventKind::kAsk && asked.size() < kReviewedAt + 1) {
      asked.push_back(event->trial);
    }
  }
  for (int i = 0; i <= kReviewedAt; ++i) {
    EXPECT_EQ(asked.at(static_cast<std::size_t>(i)), i + 1);
  }
  EXPECT_LT(result.best->outcome->scores.at("loss"), 1e-3);
}

TEST(SearchEpoch, CutShortAnywhereItComesToTheSame) {
  for (const char* algorithm : {"bobyqa", "gp", "direct_l", "random", "sobol", "cmaes"}) {
    const TemporaryFolder whole;
    search_in_epochs(whole, algorithm);
    const std::string expected = log_of(whole);
    for (const int first : {13, 26, 27, 40, 53}) {
      const TemporaryFolder folder;
      SearchResult result = search_in_epochs(folder, algorithm, first);
      EXPECT_EQ(result.termination, Termination::kInterrupted) << algorithm << first;
      for (int next = 1; result.termination == Termination::kInterrupted; next += 7) {
        result = search_in_epochs(folder, algorithm, next + 1);
      }
      EXPECT_EQ(log_of(folder), expected) << algorithm << first;
      EXPECT_EQ(result.evaluations, kEvaluations);
    }
  }
}

TEST(SearchEpoch, FixesTheReferenceOfSeveralObjectivesAnew) {
  const TemporaryFolder folder;
  const SearchResult result = search_in_epochs(folder, "sobol");
  const Storage storage = Storage::read(folder / "s.sqlite");
  const std::vector<Event> events = storage.events();
  const auto first = std::ranges::find(events, EventKind::kReference, &Event::kind);
  ASSERT_NE(first, events.end());
  const std::vector<double> last = recorded_reference(events);
  EXPECT_NE(last, first->objectives);
  EXPECT_EQ(last, result.trade_off->reference);
}

/// @param wall_clock_s  0: no limit. @param asked  how much time each review was told to be left
SearchResult search_with_clock(const TemporaryFolder& folder,
                               double wall_clock_s,
                               std::vector<TimeLeft>* asked) {
  Storage storage = Storage::open(folder / "s.sqlite", test::identity());
  RisingRung rung(storage);
  SearchTask task = task_of("bobyqa");
  task.budget.wall_clock_s = wall_clock_s;
  task.budget.evaluations = asked != nullptr ? kEvaluations : kReviewedAt + 1;
  if (asked != nullptr) {
    task.review = [&](std::span<const Trial> told, TimeLeft left) {
      asked->push_back(left);
      return left == TimeLeft::kSome ? rung.review(told) : std::nullopt;
    };
  }
  return run_search(task, storage, [&](const Point& point, int) { return rung.evaluate(point); });
}

int count_epochs(const TemporaryFolder& folder) {
  const std::vector<Event> events = Storage::read(folder / "s.sqlite").events();
  return static_cast<int>(std::ranges::count(events, EventKind::kEpoch, &Event::kind));
}

// What is withdrawn when there is no time to evaluate it again would leave no answer.
TEST(SearchEpoch, DoesNotBeginOutOfTime) {
  const TemporaryFolder folder;
  const double best = search_with_clock(folder, 0.0, nullptr).best->outcome->scores.at("loss");
  Storage::open(folder / "s.sqlite", test::identity()).set_session_seconds(3600.0);
  std::vector<TimeLeft> asked;
  const SearchResult late = search_with_clock(folder, 60.0, &asked);
  EXPECT_EQ(asked, std::vector{TimeLeft::kNone});
  EXPECT_EQ(late.termination, Termination::kWallClock);
  EXPECT_EQ(late.evaluations, kReviewedAt + 1);
  ASSERT_TRUE(late.best);
  EXPECT_EQ(late.best->outcome->scores.at("loss"), best);
  EXPECT_EQ(count_epochs(folder), 0);
  // With more time it goes on.
  asked.clear();
  EXPECT_EQ(search_with_clock(folder, 7200.0, &asked).evaluations, kEvaluations);
  EXPECT_EQ(asked.front(), TimeLeft::kSome);
  EXPECT_EQ(count_epochs(folder), 1);
}

// Killed among the evaluations that an epoch begins with, and out of time since: all of them are
// made, and no other.
TEST(SearchEpoch, EvaluatesAgainWhatItBeginsWithWhateverTheTime) {
  const TemporaryFolder folder;
  ASSERT_EQ(search_in_epochs(folder, "bobyqa", kReviewedAt + 5).termination,
            Termination::kInterrupted);
  ASSERT_EQ(count_epochs(folder), 1);
  Storage::open(folder / "s.sqlite", test::identity()).set_session_seconds(3600.0);
  std::vector<TimeLeft> asked;
  const SearchResult late = search_with_clock(folder, 60.0, &asked);
  EXPECT_EQ(late.termination, Termination::kWallClock);
  EXPECT_EQ(late.evaluations, kReviewedAt + 1);
  double least = 1.0;
  for (const Trial& trial : Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch)) {
    least = std::min(least, trial.outcome->scores.at("loss"));
  }
  EXPECT_EQ(late.best->outcome->scores.at("loss"), least);
}

TEST(SearchEpoch, NeverBegunLeavesTheSearchAsItWas) {
  const TemporaryFolder with_review;
  const TemporaryFolder without;
  const auto evaluate = [](const Point& point, int) {
    return Outcome{.scores = {{"loss", point[0] + point[1]}}};
  };
  for (const TemporaryFolder* folder : {&with_review, &without}) {
    Storage storage = Storage::open(*folder / "s.sqlite", test::identity());
    SearchTask task = task_of("bobyqa");
    if (folder == &with_review) {
      task.review = [](std::span<const Trial>, TimeLeft) { return std::optional<Event>(); };
    }
    run_search(task, storage, evaluate);
  }
  EXPECT_EQ(log_of(with_review), log_of(without));
}

}  // namespace
}  // namespace glint
