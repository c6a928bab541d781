// SPDX-License-Identifier: GPL-3.0-or-later
//
// Hand-eye calibrations of simulated cells (monte_carlo.h), 60 seeds a case: our own against
// OpenCV's seven methods on the same corners and poses. A trial has failed when the rotation is off
// by over 0.3 degrees, the translation by over 1 mm, or there is no answer. Medians: error of the
// hand-eye in degrees (`deg`) and mm (`mm`), rms error of points over the picture at noise-free
// robot poses (`px`), each over the same trial's Cramer-Rao bound (`deg_of_bound` ...); `edge_px`
// and `middle_px` beyond 1000 and within 400 px of the middle. `refused` counts trials that were
// told to be unsolvable; they are no failures. `turned`: the board's frame is upside down.
//
// Rows calibrate/coverage/CASE: shares of 500 trials whose 95 % interval holds the truth.
//
// Rows calibrate/boards/10x8 ...: sigma of the hand-eye's rotation, degrees, after so many pictures
// of a board, as its plan foretells (board_plans.h): the table of docs/theory/calibration.md.
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "hardware/calibration/opencv_methods.h"
#include "tests/hardware/calibration/monte_carlo.h"
#include "tests/hardware/upkeep/board_plans.h"

namespace glint {
namespace {

constexpr int kTrials = 60;
constexpr int kCoverageTrials = 500;
constexpr std::uint64_t kFirstSeed = 1000;
constexpr std::uint64_t kCoverageSeed = 10'000;
constexpr int kBoardSteps = 5;

/// All methods share the trials of a case.
const TrialsByMethod& trials_of(const MonteCarloCase& one) {
  static std::map<std::string, TrialsByMethod> known;
  const auto found = known.find(one.name);
  if (found != known.end()) {
    return found->second;
  }
  ThreadPool pool(hardware_threads());
  return known.emplace(one.name, run_trials(one.settings, kFirstSeed, kTrials, pool)).first->second;
}

int count_of(const std::vector<TrialErrors>& trials, bool TrialErrors::*flag) {
  return static_cast<int>(std::ranges::count(trials, true, flag));
}

void bench_case(benchmark::State& state, const MonteCarloCase& one, const std::string& method) {
  for (auto _ : state) {
    trials_of(one);
  }
  const std::vector<TrialErrors>& trials = trials_of(one).at(method);
  const auto put = [&](const char* name, auto value) {
    state.counters[name] = median_of(trials, value);
  };
  state.counters["failures"] = count_of(trials, &TrialErrors::has_failed);
  state.counters["refused"] = count_of(trials, &TrialErrors::is_refused);
  state.counters["turned"] = count_of(trials, &TrialErrors::is_turned);
  put("deg", [](const TrialErrors& e) { return e.deg; });
  put("mm", [](const TrialErrors& e) { return e.mm; });
  put("px", [](const TrialErrors& e) { return e.px.rms_px; });
  put("middle_px", [](const TrialErrors& e) { return e.px.center_px; });
  put("edge_px", [](const TrialErrors& e) { return e.px.edge_px; });
  put("deg_of_bound", [](const TrialErrors& e) { return e.deg_of_bound; });
  put("mm_of_bound", [](const TrialErrors& e) { return e.mm_of_bound; });
  put("px_of_bound", [](const TrialErrors& e) { return e.px_of_bound; });
}

void bench_coverage(benchmark::State& state, const MonteCarloCase& one) {
  ThreadPool pool(hardware_threads());
  Coverage coverage;
  for (auto _ : state) {
    coverage = run_coverage(one.settings, kCoverageSeed, kCoverageTrials, pool);
  }
  state.counters["refused"] = coverage.refused;
  for (std::size_t i = 0; i < Coverage::kNames.size(); ++i) {
    state.counters[Coverage::kNames[i]] = coverage.share(i);
  }
}

void bench_board(benchmark::State& state, const PlannedBoard& board) {
  std::vector<double> sigmas_deg;
  for (auto _ : state) {
    sigmas_deg = turn_sigmas_deg(board, kBoardSteps);
  }
  int pictures = kFirstPictures;
  for (const double sigma_deg : sigmas_deg) {
    state.counters[fmt::format("deg_{:02}", pictures)] = sigma_deg;
    pictures += kPlannedPictures;
  }
}

[[maybe_unused]] const bool are_boards_registered = [] {
  for (const PlannedBoard& board : kPlannedBoards) {
    benchmark::RegisterBenchmark(fmt::format("calibrate/boards/{}", board.name).c_str(),
                                 [board](benchmark::State& state) { bench_board(state, board); })
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1);
  }
  return true;
}();

/// Rows calibrate/CASE/METHOD; the first row of a case has the time of all its trials.
[[maybe_unused]] const bool is_registered = [] {
  std::vector<std::string> methods = {"glint"};
  for (const HandEyeMethod method : kHandEyeMethods) {
    methods.emplace_back(name_of(method));
  }
  for (const MonteCarloCase& one : monte_carlo_cases()) {
    for (const std::string& method : methods) {
      benchmark::RegisterBenchmark(
          ("calibrate/" + one.name + "/" + method).c_str(),
          [one, method](benchmark::State& state) { bench_case(state, one, method); })
          ->Unit(benchmark::kMillisecond)
          ->Iterations(1);
    }
  }
  for (const char* name : {"mid", "poses20", "small_rotations", "flips10_stamps10"}) {
    const MonteCarloCase one = monte_carlo_case(name);
    benchmark::RegisterBenchmark(("calibrate/coverage/" + one.name).c_str(),
                                 [one](benchmark::State& state) { bench_coverage(state, one); })
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1);
  }
  return true;
}();

}  // namespace
}  // namespace glint
