// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Monte Carlo of the benchmark on few trials.
#include "tests/hardware/calibration/monte_carlo.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace glint {
namespace {

TEST(RunTrials, OursIsNearTheBoundWhereOutliersMakeAllOthersFail) {
  ThreadPool pool(2);
  const TrialsByMethod trials =
      run_trials(monte_carlo_case("flips10_stamps10").settings, 1000, 2, pool);
  ASSERT_EQ(trials.size(), 8u);
  for (const auto& [method, errors] : trials) {
    for (const TrialErrors& one : errors) {
      EXPECT_EQ(one.has_failed, method != "glint") << method;
      EXPECT_FALSE(one.is_refused && method != "glint");
    }
  }
  EXPECT_LT(median_of(trials.at("glint"), [](const TrialErrors& e) { return e.deg_of_bound; }),
            2.0);
}

TEST(RunTrials, AreTheSameWithTwoThreads) {
  ThreadPool one(1);
  ThreadPool two(2);
  const CellSettings settings = {.num_poses = 8};
  const TrialsByMethod a = run_trials(settings, 5, 2, one);
  const TrialsByMethod b = run_trials(settings, 5, 2, two);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(a.at("glint")[i].mm, b.at("glint")[i].mm);
    EXPECT_EQ(a.at("park")[i].deg, b.at("park")[i].deg);
  }
}

TEST(RunCoverage, CountsEveryTrialOnce) {
  ThreadPool pool(2);
  const Coverage coverage = run_coverage({.num_poses = 10}, 7, 4, pool);
  EXPECT_EQ(coverage.solved + coverage.refused, 4);
  EXPECT_GE(coverage.solved, 3);
  for (const int held : coverage.held) {
    EXPECT_LE(held, coverage.solved);
  }
}

}  // namespace
}  // namespace glint
