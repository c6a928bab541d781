// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many simulated calibrations: our own method and OpenCV's seven on the same corners and poses,
// against the Cramer-Rao bound of the same trial; and how often intervals hold the truth.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/median.h"
#include "core/thread_pool.h"
#include "tests/hardware/calibration/corner_bank.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {

/// A kind of cell by name; noise and motions are those of the reference's Monte Carlo.
struct MonteCarloCase {
  std::string name;
  CellSettings settings;
};

std::vector<MonteCarloCase> monte_carlo_cases();

/// Cases of the reference's "mid" errors of the robot whose corners have the errors of a bank, by
/// names that begin with "bank_".
std::vector<MonteCarloCase> bank_cases(const std::shared_ptr<const CornerBank>& bank);

/// The case of that name. @throws std::out_of_range when there is none
MonteCarloCase monte_carlo_case(std::string_view name);

/// What one method makes of one trial.
struct TrialErrors {
  bool is_refused = false;  ///< told to be unsolvable, which is no failure
  bool has_failed = false;  ///< no answer, over 0.3 degrees or over 1 mm
  bool is_turned = false;   ///< the board's frame is upside down
  double deg = 0.0;         ///< of the hand-eye, below as well
  double mm = 0.0;
  PointError px;  ///< of points over the picture at noise-free robot poses
  /// Each over the root of the Cramer-Rao bound's trace, which is that of all pictures with the
  /// right terms of the lens and known sizes of all errors.
  double deg_of_bound = 0.0;
  double mm_of_bound = 0.0;
  double px_of_bound = 0.0;

  bool has_answer() const { return !is_refused && !has_failed; }
};

/// Trials by method: "glint" and the names of OpenCV's.
using TrialsByMethod = std::map<std::string, std::vector<TrialErrors>>;

/// Trials with seeds first_seed, first_seed + 1, ...
TrialsByMethod run_trials(const CellSettings& settings,
                          std::uint64_t first_seed,
                          int count,
                          ThreadPool& pool);

/// Median over the trials that were not refused; NaN when there are none.
template <class Value>
double median_of(const std::vector<TrialErrors>& trials, const Value& value);

/// How often 95 % intervals hold the truth.
struct Coverage {
  static constexpr std::array<const char*, 5> kNames = {
      "rotation", "translation", "focal", "center", "point"};
  int solved = 0;
  int refused = 0;
  std::array<int, 5> held = {};  ///< of kNames, of those solved

  double share(std::size_t i) const { return held[i] / static_cast<double>(solved); }
};

/// Chi-square of the miss by the covariance that the calibration tells, against the 95 % quantile:
/// three degrees of freedom for rotation and translation, two for focal lengths, centre and the
/// pixel of the board's first corner at a robot pose without error.
/// @param sigma_factor  makes the told standard deviations larger, for negative controls
Coverage run_coverage(const CellSettings& settings,
                      std::uint64_t first_seed,
                      int count,
                      ThreadPool& pool,
                      double sigma_factor = 1.0);

/// One line a method: failures, refused, turned, then medians in degrees, mm and px and over the
/// bound.
std::string table_of(const std::string& name, const TrialsByMethod& trials);

template <class Value>
double median_of(const std::vector<TrialErrors>& trials, const Value& value) {
  std::vector<double> values;
  for (const TrialErrors& trial : trials) {
    if (!trial.is_refused) {
      values.push_back(value(trial));
    }
  }
  return values.empty() ? std::nan("") : median(std::move(values));
}

}  // namespace glint
