// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/calibration/monte_carlo.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "core/units.h"
#include "hardware/calibration/opencv_methods.h"

namespace glint {
namespace {

/// 95 % quantiles of chi-square with two and three degrees of freedom.
constexpr double kQuantile2 = 5.991;
constexpr double kQuantile3 = 7.815;

/// At f/4, of a sensor as the gallery's calibrate_camera has it.
constexpr CornerBlur kCellBlur = {.aperture_mm = kCellFocalMm / 4.0,
                                  .focus_mm = kCellFocusMm,
                                  .image_distance_mm = kCellImageDistanceMm,
                                  .pixel_mm = kCellPixelMm,
                                  .sensor_px = 0.4};

NoiseSizes noise(double corner_px, double robot_mm, double robot_deg) {
  return {.corner_px = corner_px, .robot_rad = robot_deg * kRadPerDeg, .robot_mm = robot_mm};
}

struct Bound {
  explicit Bound(const SimulatedCell& cell) {
    const Bundle truth = bundle_at_truth(cell);
    const SharedCovariance covariance = shared_covariance(truth);
    deg = std::sqrt(covariance.diagonal().segment<3>(9).sum()) / kRadPerDeg;
    mm = std::sqrt(covariance.diagonal().segment<3>(12).sum());
    px = point_error(truth, covariance, kCellWidth, kCellHeight).rms_px;
  }

  double deg = 0.0;
  double mm = 0.0;
  double px = 0.0;
};

TrialErrors errors_of(const SimulatedCell& cell,
                      const Bound& bound,
                      const LensVector& lens,
                      const std::optional<HandEye>& poses) {
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  if (!poses.has_value()) {
    return {.has_failed = true,
            .deg = kUnbounded,
            .mm = kUnbounded,
            .px = {kUnbounded, kUnbounded, kUnbounded},
            .deg_of_bound = kUnbounded,
            .mm_of_bound = kUnbounded,
            .px_of_bound = kUnbounded};
  }
  const auto miss = miss_of(cell, lens, *poses);
  TrialErrors errors{.is_turned = miss.segment<3>(15).norm() > 90.0 * kRadPerDeg,
                     .deg = miss.segment<3>(9).norm() / kRadPerDeg,
                     .mm = miss.segment<3>(12).norm(),
                     .px = overlap_error(cell, lens, *poses)};
  errors.has_failed = errors.deg > 0.3 || errors.mm > 1.0 || !std::isfinite(errors.px.rms_px);
  errors.deg_of_bound = errors.deg / bound.deg;
  errors.mm_of_bound = errors.mm / bound.mm;
  errors.px_of_bound = errors.px.rms_px / bound.px;
  return errors;
}

HandEyeCalibration calibrated(const SimulatedCell& cell) {
  return calibrate_hand_eye(cell.pictures, cell.base_from_flange, cell_options(cell.settings));
}

/// Of an unmarked board the frame is that of the first accepted picture: turned back when that one
/// was detected upside down.
HandEye in_true_frame(const SimulatedCell& cell, const HandEyeCalibration& own) {
  const auto first =
      std::ranges::find(own.pictures, true, &HandEyePicture::accepted) - own.pictures.begin();
  HandEye poses = own.poses;
  if (cell.is_flipped[static_cast<std::size_t>(first)]) {
    const std::vector<Eigen::Vector3d> board = cell_board();
    const Eigen::Vector3d middle = 0.5 * (board.front() + board.back());
    poses.board = poses.board * board_turn({.turns = 2, .center_mm = middle}, 1);
  }
  return poses;
}

using Trial = std::map<std::string, TrialErrors>;

Trial run_trial(const CellSettings& settings, std::uint64_t seed) {
  const SimulatedCell cell = simulate_cell(settings, seed);
  const HandEyeCalibration own = calibrated(cell);
  const Bound bound(cell);
  Trial trial;
  trial["glint"] = own.succeeded ? errors_of(cell, bound, own.lens, in_true_frame(cell, own))
                                 : TrialErrors{.is_refused = true};
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
    trial[std::string(name_of(method))] = errors_of(cell, bound, own.camera.lens, poses);
  }
  return trial;
}

template <int kSize>
double chi_square(const Eigen::Matrix<double, kSize, 1>& miss,
                  const Eigen::Matrix<double, kSize, kSize>& covariance) {
  return miss.dot(covariance.ldlt().solve(miss));
}

/// Of the pixel of the board's first corner in the first picture.
double point_chi_square(const SimulatedCell& cell, const HandEyeCalibration& own) {
  const Eigen::Isometry3d& pose = cell.true_base_from_flange[0];
  const Mounting mounting = cell.settings.mounting;
  const Eigen::Vector3d point = cell_board().front();
  const auto truth =
      project_by_lens(cell.lens, camera_from_board(mounting, cell.poses, pose) * point, nullptr);
  BundleView view{.base_from_flange = pose};
  view.corners = {.board_mm = {point}, .picture_px = {*truth}};
  ViewSystem system;
  if (!evaluate_view(own.bundle, view, own.lens, {}, true, system)) {
    return std::numeric_limits<double>::infinity();
  }
  Eigen::Matrix<double, 2, 21> by;
  by << system.by_lens, system.by_hand_eye, system.by_board;
  const Eigen::Vector2d miss = system.residual_px;
  const Eigen::Matrix2d covariance = by * own.covariance * by.transpose();
  return chi_square<2>(miss, covariance);
}

/// Which of Coverage's intervals hold the truth; empty when refused.
using Held = std::optional<std::array<bool, 5>>;

Held held_by(const CellSettings& settings, std::uint64_t seed, double sigma_factor) {
  const SimulatedCell cell = simulate_cell(settings, seed);
  HandEyeCalibration own = calibrated(cell);
  own.covariance *= sigma_factor * sigma_factor;
  if (!own.succeeded) {
    return std::nullopt;
  }
  const Eigen::Matrix<double, 21, 1> miss = miss_of(cell, own.lens, own.poses);
  const auto by3 = [&](Eigen::Index at) {
    return chi_square<3>(miss.segment<3>(at), own.covariance.block<3, 3>(at, at)) <= kQuantile3;
  };
  const auto by2 = [&](Eigen::Index at) {
    return chi_square<2>(miss.segment<2>(at), own.covariance.block<2, 2>(at, at)) <= kQuantile2;
  };
  return std::array<bool, 5>{
      by3(9), by3(12), by2(0), by2(2), point_chi_square(cell, own) <= kQuantile2};
}

}  // namespace

std::vector<MonteCarloCase> monte_carlo_cases() {
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

std::vector<MonteCarloCase> bank_cases(const std::shared_ptr<const CornerBank>& bank) {
  std::vector<MonteCarloCase> cases;
  for (const char* name : {"mid", "poses20", "small_rotations", "flips10_stamps10"}) {
    MonteCarloCase one = monte_carlo_case(name);
    one.name = "bank_" + one.name;
    one.settings.corner_error = [bank](double depth_mm, const Eigen::Vector2d& row_px, Rng& rng) {
      const double turn_deg = turn_on_pixels_deg(Eigen::Vector2d::Zero(), row_px);
      return bank->draw(kCellBlur.sigma_px(depth_mm), turn_deg, rng);
    };
    cases.push_back(std::move(one));
  }
  return cases;
}

MonteCarloCase monte_carlo_case(std::string_view name) {
  for (const MonteCarloCase& one : monte_carlo_cases()) {
    if (one.name == name) {
      return one;
    }
  }
  throw std::out_of_range(std::string(name));
}

TrialsByMethod run_trials(const CellSettings& settings,
                          std::uint64_t first_seed,
                          int count,
                          ThreadPool& pool) {
  const auto trials = pool.map<Trial>(count, [&](std::int64_t i) {
    return run_trial(settings, first_seed + static_cast<std::uint64_t>(i));
  });
  TrialsByMethod result;
  for (const Trial& trial : trials) {
    for (const auto& [method, errors] : trial) {
      result[method].push_back(errors);
    }
  }
  return result;
}

Coverage run_coverage(const CellSettings& settings,
                      std::uint64_t first_seed,
                      int count,
                      ThreadPool& pool,
                      double sigma_factor) {
  const auto trials = pool.map<Held>(count, [&](std::int64_t i) {
    return held_by(settings, first_seed + static_cast<std::uint64_t>(i), sigma_factor);
  });
  Coverage coverage;
  for (const Held& trial : trials) {
    if (!trial.has_value()) {
      ++coverage.refused;
      continue;
    }
    ++coverage.solved;
    for (std::size_t i = 0; i < coverage.held.size(); ++i) {
      coverage.held[i] += (*trial)[i] ? 1 : 0;
    }
  }
  return coverage;
}

std::string table_of(const std::string& name, const TrialsByMethod& trials) {
  std::string text =
      fmt::format("{:<18} {:<10} {:>4} {:>4} {:>4} {:>8} {:>8} {:>8} {:>7} {:>7} {:>7}\n",
                  name,
                  "method",
                  "fail",
                  "ref.",
                  "turn",
                  "deg",
                  "mm",
                  "px",
                  "deg/b",
                  "mm/b",
                  "px/b");
  for (const auto& [method, method_errors] : trials) {
    const std::vector<TrialErrors>& errors = method_errors;  // older Clangs capture no binding
    const auto count = [&errors](bool TrialErrors::*flag) {
      return std::ranges::count(errors, true, flag);
    };
    text += fmt::format(
        "{:<18} {:<10} {:>4} {:>4} {:>4} {:>8.4g} {:>8.4g} {:>8.4g} {:>7.3g} {:>7.3g} {:>7.3g}\n",
        "",
        method,
        count(&TrialErrors::has_failed),
        count(&TrialErrors::is_refused),
        count(&TrialErrors::is_turned),
        median_of(errors, [](const TrialErrors& e) { return e.deg; }),
        median_of(errors, [](const TrialErrors& e) { return e.mm; }),
        median_of(errors, [](const TrialErrors& e) { return e.px.rms_px; }),
        median_of(errors, [](const TrialErrors& e) { return e.deg_of_bound; }),
        median_of(errors, [](const TrialErrors& e) { return e.mm_of_bound; }),
        median_of(errors, [](const TrialErrors& e) { return e.px_of_bound; }));
  }
  return text;
}

}  // namespace glint
