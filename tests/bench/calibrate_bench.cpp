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
// Rows calibrate/bank_CASE/METHOD and calibrate/coverage/bank_CASE: the same with corners whose
// errors are drawn from rendered pictures (corner_bank.h) in place of Gaussian ones of set size;
// GLINT_CORNER_BANK names the file, which `script/bench calibrate bank` makes. `corner_px`: the
// root mean square of the errors that the first trial drew, along one axis.
//
// Rows calibrate/boards/10x8 ...: sigma of the hand-eye's rotation, degrees, after so many pictures
// of a board, as its plan foretells (board_plans.h): the table of docs/theory/calibration.md.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "core/error.h"
#include "hardware/calibration/opencv_methods.h"
#include "tests/hardware/calibration/corner_bank_file.h"
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
  state.counters["corner_px"] = simulate_cell(one.settings, kFirstSeed).settings.noise.corner_px;
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

/// The bank that the environment names; without one, or one that will do, a word on the terminal.
std::shared_ptr<const CornerBank> bank_of_environment() {
  const char* file = std::getenv("GLINT_CORNER_BANK");
  if (file == nullptr || !std::filesystem::exists(file)) {
    fmt::print(stderr,
               "calibrate: corner noise is Gaussian of set size; \"script/bench calibrate bank\" "
               "renders pictures from whose corners it is drawn\n");
    return nullptr;
  }
  try {
    const std::vector<BankPicture> pictures = read_corner_bank(file);
    fmt::print(stderr, "calibrate: corner errors of {} pictures in {}\n", pictures.size(), file);
    return std::make_shared<const CornerBank>(pictures);
  } catch (const Error& error) {
    fmt::print(stderr, "calibrate: no rows of the bank: {}\n", error.what());
    return nullptr;
  }
}

/// Rows calibrate/CASE/METHOD; the first row of a case has the time of all its trials.
void register_case(const MonteCarloCase& one) {
  std::vector<std::string> methods = {"glint"};
  for (const HandEyeMethod method : kHandEyeMethods) {
    methods.emplace_back(name_of(method));
  }
  for (const std::string& method : methods) {
    benchmark::RegisterBenchmark(
        ("calibrate/" + one.name + "/" + method).c_str(),
        [one, method](benchmark::State& state) { bench_case(state, one, method); })
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1);
  }
}

void register_coverage(const MonteCarloCase& one) {
  benchmark::RegisterBenchmark(("calibrate/coverage/" + one.name).c_str(),
                               [one](benchmark::State& state) { bench_coverage(state, one); })
      ->Unit(benchmark::kMillisecond)
      ->Iterations(1);
}

[[maybe_unused]] const bool is_registered = [] {
  for (const MonteCarloCase& one : monte_carlo_cases()) {
    register_case(one);
  }
  for (const char* name : {"mid", "poses20", "small_rotations", "flips10_stamps10"}) {
    register_coverage(monte_carlo_case(name));
  }
  if (const auto bank = bank_of_environment()) {
    for (const MonteCarloCase& one : bank_cases(bank)) {
      register_case(one);
      register_coverage(one);
    }
  }
  return true;
}();

}  // namespace
}  // namespace glint
