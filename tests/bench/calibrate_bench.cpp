// SPDX-License-Identifier: GPL-3.0-or-later
//
// Hand-eye calibrations of simulated cells, 60 seeds a case: our own against OpenCV's seven methods
// on the same corners and poses. Corner noise, robot errors and cases are those of the reference's
// Monte Carlo; a trial has failed when the rotation is off by over 0.3 degrees, the translation by
// over 1 mm, or there is no answer. Medians: error of the hand-eye in degrees (`deg`) and mm
// (`mm`), rms error of points over the picture at noise-free robot poses (`px`), each over the same
// trial's Cramer-Rao bound (`deg_of_bound` ...); `edge_px` and `middle_px` beyond 1000 and within
// 400 px of the middle. The bound is that of all pictures with the right terms of the lens and
// known sizes of all errors. `refused` counts trials that were told to be unsolvable; they are no
// failures.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "hardware/calibration/opencv_methods.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

constexpr int kTrials = 60;
constexpr double kDegree = std::numbers::pi / 180.0;

struct Case {
  std::string name;
  CellSettings settings;
};

NoiseSizes noise(double corner_px, double robot_mm, double robot_deg) {
  return {.corner_px = corner_px, .robot_rad = robot_deg * kDegree, .robot_mm = robot_mm};
}

std::vector<Case> cases() {
  return {{"mid", {}},
          {"good", {.noise = noise(0.1, 0.03, 0.01)}},
          {"bad", {.noise = noise(0.3, 0.1, 0.05)}},
          {"eye_to_hand", {.mounting = Mounting::kEyeToHand}},
          {"one_axis", {.tilt_y_deg = 1.0, .roll_deg = 1.0}},
          {"small_rotations", {.tilt_x_deg = 5.0, .tilt_y_deg = 5.0, .roll_deg = 5.0}},
          {"flat_narrow", {.tilt_x_deg = 8.0, .tilt_y_deg = 8.0, .distance_mm = 3.0}},
          {"poses20", {.num_poses = 20}},
          {"poses5", {.num_poses = 5}},
          {"flips10", {.flipped_share = 0.1}},
          {"stamps10", {.wrong_share = 0.1}},
          {"flips10_stamps10", {.flipped_share = 0.1, .wrong_share = 0.1}}};
}

/// What one method makes of one trial.
struct Errors {
  bool is_there = false;
  double deg = 0.0;
  double mm = 0.0;
  PointError px;
};

/// One method's trials of a case.
struct Row {
  std::vector<Errors> errors;
  std::vector<double> deg_of_bound;
  std::vector<double> mm_of_bound;
  std::vector<double> px_of_bound;
  int failures = 0;
  int refused = 0;
};

struct Bound {
  explicit Bound(const SimulatedCell& cell) {
    const Bundle truth = bundle_at_truth(cell);
    const SharedCovariance covariance = shared_covariance(truth);
    deg = std::sqrt(covariance.diagonal().segment<3>(9).sum()) / kDegree;
    mm = std::sqrt(covariance.diagonal().segment<3>(12).sum());
    px = point_error(truth, covariance, kCellWidth, kCellHeight).rms_px;
  }

  double deg = 0.0;
  double mm = 0.0;
  double px = 0.0;
};

void add(Row& row,
         const Bound& bound,
         const SimulatedCell& cell,
         const LensVector& lens,
         const std::optional<HandEye>& poses) {
  if (!poses.has_value()) {
    ++row.failures;
    return;
  }
  const auto miss = miss_of(cell, lens, *poses);
  const Errors errors{.is_there = true,
                      .deg = miss.segment<3>(9).norm() / kDegree,
                      .mm = miss.segment<3>(12).norm(),
                      .px = overlap_error(cell, lens, *poses)};
  row.errors.push_back(errors);
  row.failures += errors.deg > 0.3 || errors.mm > 1.0 || !std::isfinite(errors.px.rms_px) ? 1 : 0;
  row.deg_of_bound.push_back(errors.deg / bound.deg);
  row.mm_of_bound.push_back(errors.mm / bound.mm);
  row.px_of_bound.push_back(errors.px.rms_px / bound.px);
}

using Rows = std::map<std::string, Row>;

void run_trial(const CellSettings& settings, std::uint64_t seed, Rows& rows) {
  const SimulatedCell cell = simulate_cell(settings, seed);
  const HandEyeCalibration own =
      calibrate_hand_eye(cell.pictures, cell.base_from_flange, cell_options(settings));
  const Bound bound(cell);
  if (own.succeeded) {
    add(rows["glint"], bound, cell, own.lens, own.poses);
  } else {
    ++rows["glint"].refused;
  }
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
    if (own.camera.pictures[i].accepted) {
      pairs.push_back({.base_from_flange = cell.base_from_flange[i],
                       .camera_from_board = own.camera.pictures[i].camera_from_board});
    }
  }
  for (const HandEyeMethod method : kHandEyeMethods) {
    const auto poses =
        pairs.size() < 3 ? std::nullopt : hand_eye_by(method, settings.mounting, pairs);
    add(rows[std::string(name_of(method))], bound, cell, own.camera.lens, poses);
  }
}

/// All methods share the trials of a case.
const Rows& rows_of(const Case& one) {
  static std::map<std::string, Rows> known;
  auto [at, is_new] = known.try_emplace(one.name);
  for (int trial = 0; is_new && trial < kTrials; ++trial) {
    run_trial(one.settings, 1000 + static_cast<std::uint64_t>(trial), at->second);
  }
  return at->second;
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return std::nan("");
  }
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

template <class Value>
double median_of(const Row& row, const Value& value) {
  std::vector<double> values;
  for (const Errors& errors : row.errors) {
    values.push_back(value(errors));
  }
  return median(values);
}

void bench_case(benchmark::State& state, const Case& one, const std::string& method) {
  for (auto _ : state) {
    rows_of(one);
  }
  const Rows& rows = rows_of(one);
  const auto found = rows.find(method);
  const Row row = found != rows.end() ? found->second : Row{};
  state.counters["failures"] = row.failures;
  state.counters["refused"] = row.refused;
  state.counters["deg"] = median_of(row, [](const Errors& e) { return e.deg; });
  state.counters["mm"] = median_of(row, [](const Errors& e) { return e.mm; });
  state.counters["px"] = median_of(row, [](const Errors& e) { return e.px.rms_px; });
  state.counters["middle_px"] = median_of(row, [](const Errors& e) { return e.px.center_px; });
  state.counters["edge_px"] = median_of(row, [](const Errors& e) { return e.px.edge_px; });
  state.counters["deg_of_bound"] = median(row.deg_of_bound);
  state.counters["mm_of_bound"] = median(row.mm_of_bound);
  state.counters["px_of_bound"] = median(row.px_of_bound);
}

/// Rows calibrate/CASE/METHOD; the first row of a case has the time of all its trials.
[[maybe_unused]] const bool is_registered = [] {
  for (const Case& one : cases()) {
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
  return true;
}();

}  // namespace
}  // namespace glint
