// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `script/bench calibrate` measures, with limits. GLINT_TRIALS=20 and
// GLINT_COVERAGE_TRIALS=100 in the environment make them fewer; GLINT_CASES=1 prints all cases.
#include <cstdlib>
#include <iostream>

#include <gtest/gtest.h>

#include "tests/hardware/calibration/monte_carlo.h"

namespace glint {
namespace {

int trials_from(const char* variable, int otherwise) {
  const char* given = std::getenv(variable);
  return given != nullptr ? std::atoi(given) : otherwise;
}

constexpr int kWeakTrials = 100;

int num_trials() {
  return trials_from("GLINT_TRIALS", 60);
}

void expect_near_bound(const std::vector<TrialErrors>& trials, double limit) {
  for (const TrialErrors& trial : trials) {
    EXPECT_TRUE(trial.has_answer()) << trial.deg << " degrees " << trial.mm << " mm";
    EXPECT_FALSE(trial.is_turned);
  }
  EXPECT_LE(median_of(trials, [](const TrialErrors& e) { return e.deg_of_bound; }), limit);
  EXPECT_LE(median_of(trials, [](const TrialErrors& e) { return e.mm_of_bound; }), limit);
  EXPECT_LE(median_of(trials, [](const TrialErrors& e) { return e.px_of_bound; }), limit);
}

TEST(MonteCarlo, MediansAreNearTheCramerRaoBound) {
  ThreadPool pool(2);
  const TrialsByMethod trials = run_trials({}, 1000, num_trials(), pool);
  std::cout << table_of("mid", trials);
  expect_near_bound(trials.at("glint"), 1.15);
}

TEST(MonteCarlo, FlipsAndWrongStampsMakeAllOthersFailAndCostUsLittle) {
  ThreadPool pool(2);
  const TrialsByMethod trials =
      run_trials(monte_carlo_case("flips10_stamps10").settings, 1000, num_trials(), pool);
  std::cout << table_of("flips10_stamps10", trials);
  for (const auto& [method, errors] : trials) {
    if (method == "glint") {
      expect_near_bound(errors, 1.3);
      continue;
    }
    for (const TrialErrors& error : errors) {
      EXPECT_TRUE(error.has_failed) << method;
    }
  }
}

TEST(MonteCarlo, IntervalsHoldTheTruthAsOftenAsTheySay) {
  ThreadPool pool(2);
  // Of 500 trials 475 +- 4.9 are expected; 91 and 99 % are 4 sigma off.
  const int count = trials_from("GLINT_COVERAGE_TRIALS", 500);
  const Coverage coverage = run_coverage(monte_carlo_case("poses20").settings, 10'000, count, pool);
  EXPECT_LE(coverage.refused, count / 10);
  for (std::size_t i = 0; i < Coverage::kNames.size(); ++i) {
    std::cout << Coverage::kNames[i] << ' ' << coverage.share(i) << '\n';
    EXPECT_GE(coverage.share(i), 0.91) << Coverage::kNames[i];
    EXPECT_LE(coverage.share(i), 0.99) << Coverage::kNames[i];
  }
}

/// What is not refused is known as well as is told.
TEST(MonteCarlo, IntervalsOfWeakGeometryHoldTheTruth) {
  ThreadPool pool(2);
  for (const char* name : {"one_axis", "flat_narrow", "poses5", "small_rotations"}) {
    const Coverage coverage =
        run_coverage(monte_carlo_case(name).settings, 20'000, kWeakTrials, pool);
    EXPECT_EQ(coverage.solved + coverage.refused, kWeakTrials) << name;
    for (std::size_t i = 0; i < Coverage::kNames.size() && coverage.solved > 0; ++i) {
      std::cout << name << ' ' << Coverage::kNames[i] << ' ' << coverage.share(i) << " of "
                << coverage.solved << '\n';
      EXPECT_GE(coverage.share(i), 0.9) << name << ' ' << Coverage::kNames[i];
    }
  }
}

TEST(MonteCarlo, IntervalsThatAreTooSmallAreNoticed) {
  // Negative control: a chi-square of three degrees of freedom is below 7.8 / 4 in 42 %.
  ThreadPool pool(2);
  const Coverage coverage =
      run_coverage(monte_carlo_case("poses20").settings, 10'000, 20, pool, 0.5);
  for (std::size_t i = 0; i < Coverage::kNames.size(); ++i) {
    EXPECT_LT(coverage.share(i), 0.89) << Coverage::kNames[i];
  }
}

TEST(MonteCarlo, CasesAreTold) {
  if (trials_from("GLINT_CASES", 0) == 0) {
    GTEST_SKIP() << "prints all cases with GLINT_CASES=1";
  }
  ThreadPool pool(2);
  for (const MonteCarloCase& one : monte_carlo_cases()) {
    std::cout << table_of(one.name, run_trials(one.settings, 1000, num_trials(), pool))
              << std::flush;
  }
}

}  // namespace
}  // namespace glint
