// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/search.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "tests/optimizer/algorithm/problems.h"

namespace glint {
namespace {

using test::box;
using test::identity;
using testing::HasSubstr;

/// Minimises "loss" in a box.
SearchTask simple_task(int num_dimensions, int evaluations) {
  return {.space = box(num_dimensions, 0, 1),
          .goal = {.objective = {.name = "loss", .is_maximised = false}},
          .budget = {.evaluations = evaluations}};
}

Outcome loss(double value) {
  return {.scores = {{"loss", value}}};
}

double bowl(const Point& p) {
  double sum = 0.0;
  for (const double x : p) {
    sum += (x - 0.3) * (x - 0.3);
  }
  return sum;
}

Outcome noisy_bowl(const Point& p, int trial) {
  Outcome outcome = loss(bowl(p) + test::noise(trial));
  outcome.scores["length"] = p[0];
  for (const double x : p) {
    outcome.gradients["loss"].push_back(2.0 * (x - 0.3));
  }
  return outcome;
}

SearchResult run_in(const TemporaryFolder& folder,
                    const SearchTask& task,
                    const Evaluate& evaluate,
                    const std::atomic<int>* interrupt = nullptr,
                    const OnEvaluation& progress = {}) {
  Storage storage = Storage::open(folder / "s.sqlite", identity());
  return run_search(task, storage, evaluate, interrupt, progress);
}

/// What must not depend on how the run was cut up: points, scores, asks and tells.
std::string trace_of(const TemporaryFolder& folder) {
  const Storage storage = Storage::read(folder / "s.sqlite");
  std::string trace;
  for (const Event& event : storage.events()) {
    if (event.kind == EventKind::kAsk || event.kind == EventKind::kTell) {
      trace += fmt::format("{} {} {:a}\n", static_cast<int>(event.kind), event.trial, event.value);
    }
  }
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    trace += fmt::format("{} {:a}", trial.number, fmt::join(trial.point, " "));
    if (trial.outcome && !trial.outcome->is_failed) {
      trace += fmt::format(" = {:a}", trial.outcome->scores.at("loss"));
    }
    trace += '\n';
  }
  return trace;
}

TEST(RunSearch, FindsTheMinimumAndSpendsTheBudgetExactly) {
  const TemporaryFolder folder;
  int calls = 0;
  const SearchResult result = run_in(folder, simple_task(4, 90), [&](const Point& p, int) {
    ++calls;
    return loss(bowl(p));
  });
  EXPECT_EQ(result.termination, Termination::kEvaluations);
  EXPECT_EQ(calls, 90);
  EXPECT_EQ(result.evaluations, 90);
  EXPECT_EQ(result.algorithm, "bobyqa");
  ASSERT_TRUE(result.best.has_value());
  EXPECT_TRUE(result.is_feasible);
  EXPECT_LT(result.best->outcome->scores.at("loss"), 1e-4);
}

TEST(RunSearch, StartPointsAreTheFirstTrials) {
  const TemporaryFolder folder;
  SearchTask task = simple_task(3, 12);
  task.start_points = {{0.5, 0.25, 0.125}};
  std::map<int, Point> points;
  run_in(folder, task, [&](const Point& p, int trial) {
    points[trial] = p;
    return loss(bowl(p));
  });
  EXPECT_EQ(points.at(1), task.start_points[0]);
  EXPECT_EQ(points.size(), 12U);
  EXPECT_EQ(points.rbegin()->first, 12);
}

/// max x + y with x^2 + y^2 <= 1 on [0, 2]^2: sqrt(2) at x = y = 1 / sqrt(2).
TEST(RunSearch, FindsAConstrainedOptimum) {
  for (const char* algorithm : {"auto", "bobyqa", "cobyla", "sbplx", "direct_l"}) {
    const TemporaryFolder folder;
    SearchTask task = {
        .space = box(2, 0, 2),
        .settings = {.algorithm = algorithm},
        .goal = {.objective = {.name = "sum"}, .constraints = {{.name = "square", .max = 1.0}}},
        .budget = {.evaluations = 400}};
    const SearchResult result = run_in(folder, task, [](const Point& p, int) {
      return Outcome{.scores = {{"sum", p[0] + p[1]}, {"square", p[0] * p[0] + p[1] * p[1]}}};
    });
    ASSERT_TRUE(result.is_feasible) << algorithm;
    EXPECT_LE(result.best->outcome->scores.at("square"), 1.0);
    EXPECT_NEAR(result.best->outcome->scores.at("sum"), std::sqrt(2.0), 0.02) << algorithm;
  }
}

TEST(RunSearch, ReportsTheLeastViolationWhenNothingIsFeasible) {
  const TemporaryFolder folder;
  SearchTask task = simple_task(3, 80);
  task.goal.constraints = {{.name = "x", .min = 2.0}};  // x goes to 1 only
  const SearchResult result = run_in(folder, task, [](const Point& p, int) {
    return Outcome{.scores = {{"loss", p[1]}, {"x", p[0]}}};
  });
  EXPECT_FALSE(result.is_feasible);
  EXPECT_GT(result.best->outcome->scores.at("x"), 0.99);
}

TEST(RunSearch, AFailedEvaluationIsATrialWithItsReason) {
  const TemporaryFolder folder;
  const SearchResult result =
      run_in(folder, simple_task(3, 60), [](const Point& p, int trial) -> Outcome {
        switch (trial % 5) {
          case 1:
            throw ConfigError("camera inside the part");
          case 2:
            return loss(std::nan(""));
          case 3:
            return {.scores = {{"other", 1.0}}};
          default:
            return loss(bowl(p));
        }
      });
  EXPECT_EQ(result.evaluations, 60);
  EXPECT_EQ(result.failed, 36);
  const auto trials = Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch);
  EXPECT_EQ(trials[0].outcome->message, "camera inside the part");
  EXPECT_EQ(trials[1].outcome->message, "score \"loss\" is NaN");
  EXPECT_EQ(trials[2].outcome->message, "there is no score \"loss\"");
  EXPECT_TRUE(trials[2].outcome->is_failed);
  EXPECT_FALSE(trials[3].outcome->is_failed);
}

TEST(RunSearch, StopsWhenTheFirstTenAllFail) {
  const TemporaryFolder folder;
  const SearchResult result =
      run_in(folder, simple_task(3, 60), [](const Point&, int) -> Outcome { throw Error("no"); });
  EXPECT_EQ(result.termination, Termination::kFailures);
  EXPECT_EQ(result.failed, 10);
  EXPECT_FALSE(result.best.has_value());
}

TEST(RunSearch, AnExceptionThatIsNotOursGoesThrough) {
  const TemporaryFolder folder;
  EXPECT_THROW(run_in(folder,
                      simple_task(3, 60),
                      [](const Point&, int) -> Outcome { throw std::logic_error("bug"); }),
               std::logic_error);
}

TEST(RunSearch, StopsByStallAndByTarget) {
  const TemporaryFolder stalled;
  SearchTask task = simple_task(3, 500);
  task.budget.stall = 25;
  const SearchResult flat = run_in(stalled, task, [](const Point&, int) { return loss(1.0); });
  EXPECT_EQ(flat.termination, Termination::kStall);
  EXPECT_EQ(flat.evaluations, 26);  // the first one is the best, 25 are no better

  const TemporaryFolder reached;
  task.budget = {.evaluations = 500, .target = 0.01};
  const SearchResult result =
      run_in(reached, task, [](const Point& p, int) { return loss(bowl(p)); });
  EXPECT_EQ(result.termination, Termination::kTarget);
  EXPECT_LE(result.best->outcome->scores.at("loss"), 0.01);
  EXPECT_EQ(result.best->number, result.evaluations);
}

// Every design is a little better than the one before. Half the interval of one design is 0.3, of a
// difference 0.3 sqrt(2) = 0.42: of 1, 0.99, 0.98 ... the 44th design is the first one beyond.
TEST(RunSearch, CountsNoDesignAsBetterWithinTheNoise) {
  const auto slowly_better = [](double half_width) {
    return [half_width](const Point&, int trial) {
      const double value = 1.0 - 0.01 * (trial - 1);
      Outcome outcome = loss(value);
      outcome.scores["loss.low"] = value - half_width;
      outcome.scores["loss.high"] = value + half_width;
      return outcome;
    };
  };
  SearchTask task = simple_task(3, 60);
  task.budget.stall = 25;
  const TemporaryFolder noisy;
  const SearchResult stopped = run_in(noisy, task, slowly_better(0.3));
  EXPECT_EQ(stopped.termination, Termination::kStall);
  EXPECT_EQ(stopped.evaluations, 26);
  EXPECT_EQ(stopped.best->number, 26);  // the best is the best all the same
  const TemporaryFolder patient;
  task.budget.stall = 43;
  EXPECT_EQ(run_in(patient, task, slowly_better(0.3)).termination, Termination::kEvaluations);
  const TemporaryFolder quiet;
  task.budget.stall = 25;
  EXPECT_EQ(run_in(quiet, task, slowly_better(0.0)).termination, Termination::kEvaluations);
}

TEST(RunSearch, StopsByWallClockOverResumes) {
  const TemporaryFolder folder;
  SearchTask task = simple_task(3, 0);
  task.budget.wall_clock_s = 0.1;
  const Evaluate slow = [](const Point& p, int) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return loss(bowl(p));
  };
  const SearchResult first = run_in(folder, task, slow);
  EXPECT_EQ(first.termination, Termination::kWallClock);
  EXPECT_LE(first.evaluations, 10);
  const SearchResult second = run_in(folder, task, slow);
  EXPECT_EQ(second.termination, Termination::kWallClock);
  EXPECT_EQ(second.evaluations, first.evaluations);
}

TEST(RunSearch, EvaluatesEqualPointsOnce) {
  const TemporaryFolder folder;
  SearchTask task = simple_task(1, 500);
  task.space.variables[0].step = 0.1;  // eleven designs
  task.settings.algorithm = "cobyla";
  std::set<Point> points;
  const SearchResult result = run_in(folder, task, [&](const Point& p, int) {
    EXPECT_TRUE(points.insert(p).second);
    return loss(bowl(p));
  });
  EXPECT_EQ(result.termination, Termination::kExhausted);
  EXPECT_LE(result.evaluations, 11);
  EXPECT_GT(result.reused, 100);
  EXPECT_NEAR(result.best->point[0], 0.3, 1e-12);
}

TEST(RunSearch, ResultsDoNotDependOnJobs) {
  for (const std::string_view algorithm : algorithm_names()) {
    SearchTask task = simple_task(4, 70);
    task.settings.algorithm = algorithm;
    task.settings.batch = 7;
    if (needs_several_objectives(algorithm)) {
      task.goal.more_objectives = {{.name = "length", .is_maximised = true}};
    }
    std::set<std::string> traces;
    for (const int jobs : {1, 2, 7}) {
      const TemporaryFolder folder;
      task.jobs = jobs;
      run_in(folder, task, [jobs](const Point& p, int trial) {
        std::this_thread::sleep_for(std::chrono::microseconds(jobs > 1 ? 300 * (trial % 3) : 0));
        return noisy_bowl(p, trial);
      });
      traces.insert(trace_of(folder));
    }
    EXPECT_EQ(traces.size(), 1U) << algorithm;
  }
}

TEST(RunSearch, RunsAsManyEvaluationsAtOnceAsItHasJobs) {
  const TemporaryFolder folder;
  SearchTask task = simple_task(4, 24);
  task.settings.batch = 4;
  task.jobs = 2;
  std::atomic<int> running = 0;
  std::atomic<int> maximum = 0;
  run_in(folder, task, [&](const Point& p, int) {
    maximum = std::max(maximum.load(), ++running);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    --running;
    return loss(bowl(p));
  });
  EXPECT_EQ(maximum.load(), 2);
}

TEST(RunSearch, AnInterruptFinishesWhatRunsAndCanBeResumed) {
  SearchTask task = simple_task(4, 60);
  task.settings.batch = 4;
  task.jobs = 2;
  const TemporaryFolder at_once;
  run_in(at_once, task, noisy_bowl);
  const TemporaryFolder folder;
  int runs = 0;
  for (SearchResult result{.termination = Termination::kInterrupted};
       result.termination == Termination::kInterrupted;
       ++runs) {
    ASSERT_LT(runs, 30);
    std::atomic<int> interrupt = 0;
    std::atomic<int> calls = 0;
    std::atomic<int> finished = 0;
    result = run_in(
        folder,
        task,
        [&](const Point& p, int trial) {
          if (++calls == 7) {
            interrupt = 1;
          }
          Outcome outcome = noisy_bowl(p, trial);
          ++finished;
          return outcome;
        },
        &interrupt);
    EXPECT_EQ(calls.load(), finished.load());
    EXPECT_LE(calls.load(), 8);  // the other job may have one running
  }
  EXPECT_GE(runs, 8);
  EXPECT_EQ(trace_of(at_once), trace_of(folder));
}

TEST(RunSearch, AnAbortedEvaluationIsDoneAgain) {
  const TemporaryFolder folder;
  std::atomic<int> interrupt = 0;
  const SearchResult first = run_in(
      folder,
      simple_task(3, 20),
      [&](const Point& p, int trial) -> Outcome {
        if (trial == 5) {
          interrupt = 2;
          throw EvaluationAborted();
        }
        return loss(bowl(p));
      },
      &interrupt);
  EXPECT_EQ(first.termination, Termination::kInterrupted);
  EXPECT_EQ(first.evaluations, 4);
  std::vector<int> trials;
  const SearchResult second = run_in(folder, simple_task(3, 20), [&](const Point& p, int trial) {
    trials.push_back(trial);
    return loss(bowl(p));
  });
  EXPECT_EQ(second.replayed, 4);
  EXPECT_EQ(trials.front(), 5);
  EXPECT_EQ(second.evaluations, 20);
}

TEST(RunSearch, ReportsProgressAfterEachEvaluation) {
  const TemporaryFolder folder;
  int calls = 0;
  double best = 1e300;
  run_in(
      folder,
      simple_task(3, 25),
      [](const Point& p, int) { return loss(bowl(p)); },
      nullptr,
      [&](const SearchProgress& progress) {
        EXPECT_EQ(progress.evaluations, ++calls);
        EXPECT_EQ(progress.last.number, calls);
        best = std::min(best, progress.last.outcome->scores.at("loss"));
        EXPECT_EQ(progress.best->outcome->scores.at("loss"), best);
      });
  EXPECT_EQ(calls, 25);
}

TEST(RunSearch, RefusesToResumeWhatWouldNowGoAnotherWay) {
  const TemporaryFolder folder;
  SearchTask task = simple_task(3, 20);
  run_in(folder, task, noisy_bowl);
  // As if the program had changed without the config hash noticing.
  task.settings.seed = 2;
  task.budget.evaluations = 30;
  try {
    run_in(folder, task, noisy_bowl);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("trial 1 was recorded as"));
    EXPECT_THAT(error.what(), HasSubstr("changed since"));
  }
}

TEST(RunSearch, RefusesAWrongTask) {
  const auto message = [](const SearchTask& task) -> std::string {
    const TemporaryFolder folder;
    try {
      run_in(folder, task, noisy_bowl);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  SearchTask task = simple_task(3, 0);
  EXPECT_THAT(message(task), HasSubstr("at least one of"));
  task.budget.evaluations = -1;
  EXPECT_THAT(message(task), HasSubstr("negative"));
  task = simple_task(3, 5);
  task.jobs = 0;
  EXPECT_THAT(message(task), HasSubstr("jobs"));
  task = simple_task(3, 5);
  task.start_points = {{1.0}};
  EXPECT_THAT(message(task), HasSubstr("start point"));
  task = simple_task(3, 5);
  task.space.variables[0].low = 7.0;
  EXPECT_THAT(message(task), HasSubstr("min 7 is above max 1"));
}

}  // namespace
}  // namespace glint
