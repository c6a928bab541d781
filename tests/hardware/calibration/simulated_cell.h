// SPDX-License-Identifier: GPL-3.0-or-later
//
// Corners and robot poses of a simulated calibration: a narrow field of view at close range, as
// the reference's Monte Carlo has it. Used by tests and by the benchmark.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/rng.h"
#include "hardware/calibration/hand_eye_calibration.h"

namespace glint {

/// The error of a corner, px.
/// @param depth_mm  of the corner, along the optical axis
/// @param row_px    from one corner of the board's middle row to another, in the picture
using CornerError =
    std::function<Eigen::Vector2d(double depth_mm, const Eigen::Vector2d& row_px, Rng& rng)>;

/// How the pictures are taken and what is wrong with them. Defaults: the reference's "mid" noise.
struct CellSettings {
  Mounting mounting = Mounting::kEyeInHand;
  int num_poses = 80;
  double tilt_x_deg = 30.0;  ///< largest, uniform
  double tilt_y_deg = 30.0;
  double roll_deg = 40.0;
  double distance_mm = 12.0;  ///< largest change of the distance
  double spread_mm = 16.0;    ///< largest shift of the board
  NoiseSizes noise = {.corner_px = 0.2, .robot_rad = 0.02 * 0.017453292519943295, .robot_mm = 0.05};
  /// Errors that neighbouring corners share, as of a board that is not flat: a random polynomial of
  /// second order in each picture, this size in each of its terms.
  double shared_px = 0.0;
  double flipped_share = 0.0;  ///< pictures whose board is detected upside down, never the first
  double wrong_share = 0.0;    ///< pictures with the robot pose of the next one
  /// In place of Gaussian errors of the size noise.corner_px; of the simulated cell that is then
  /// the root mean square of the errors along one axis. Empty: Gaussian.
  CornerError corner_error = {};
};

/// Measurements and truth.
struct SimulatedCell {
  CellSettings settings;
  LensVector lens;
  HandEye poses;
  std::vector<BoardCorners> pictures;
  std::vector<Eigen::Isometry3d> base_from_flange;       ///< as reported
  std::vector<Eigen::Isometry3d> true_base_from_flange;  ///< as they are
  std::vector<bool> is_flipped;
  std::vector<bool> is_wrong;
};

inline constexpr int kCellWidth = 2448;
inline constexpr int kCellHeight = 2050;
inline constexpr double kCellFocalMm = 12.0;   ///< of the lens
inline constexpr double kCellFocusMm = 146.0;  ///< the depth that is sharp
inline constexpr double kCellPixelMm = 3.45e-3;

/// From the lens to the sensor.
inline constexpr double kCellImageDistanceMm = 1.0 / (1.0 / kCellFocalMm - 1.0 / kCellFocusMm);

/// 10 x 8 inner corners of 6.6 mm: looks the same after half a turn.
std::vector<Eigen::Vector3d> cell_board();

SimulatedCell simulate_cell(const CellSettings& settings, std::uint64_t seed);

/// Options that fit the cell: its size of picture and its board.
HandEyeOptions cell_options(const CellSettings& settings);

/// The bundle at the truth: shared_covariance() of it is the Cramer-Rao bound with the terms k1 k2
/// p1 p2 and known noise sizes, from all pictures as if none were wrong.
Bundle bundle_at_truth(const SimulatedCell& cell);

/// Lens, hand-eye and board increments by which an estimate misses the truth.
Eigen::Matrix<double, 21, 1> miss_of(const SimulatedCell& cell,
                                     const LensVector& lens,
                                     const HandEye& poses);

/// Rms over the picture of points in the board's plane computed with the estimate, against the
/// truth, at the true robot poses; {all, middle third, outer corners}.
PointError overlap_error(const SimulatedCell& cell, const LensVector& lens, const HandEye& poses);

}  // namespace glint
