// SPDX-License-Identifier: GPL-3.0-or-later
//
// Table of a study that tries a calibration out: [calibration_trial]. Pictures of a board are
// rendered and calibrated as if they were photographs; the scene's own [camera], [calibration] and
// [cell] are the truth.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/config/key_writer.h"
#include "core/config/keys.h"
#include "core/units.h"

namespace glint {

struct SceneSettings;

/// The [calibration_trial] table.
struct CalibrationTrialSettings {
  std::filesystem::path board;                 ///< board.toml or board.json
  int pictures = 12;                           ///< >= 3
  int seed = 1;                                ///< of the poses and of the robot's errors
  Interval distance_mm = {140.0, 160.0};       ///< from the lens to the board's middle
  double tilt_rad = 30.0 * kRadPerDeg;         ///< at most, about each of the board's two axes
  double roll_rad = 40.0 * kRadPerDeg;         ///< at most, about the view
  double shift_mm = 5.0;                       ///< at most, of the board's middle from the view's
  double robot_sigma_mm = 0.05;                ///< standard deviation along each axis
  double robot_sigma_rad = 0.02 * kRadPerDeg;  ///< about each axis
  double paper = 0.8;                          ///< reflectance, in (0, 1]
  double ink = 0.04;                           ///< reflectance, less than the paper's
};

void visit_keys(KeyVisitor& keys, CalibrationTrialSettings& settings);

/// Reads the table; empty when the file has none.
/// @param scene   must tell where camera and board are at the robot
/// @param errors  grows by the problems found
std::optional<CalibrationTrialSettings> read_calibration_trial(const ConfigNode& root,
                                                               const SceneSettings& scene,
                                                               std::vector<Problem>& errors);

/// The table with every key present.
ConfigNode write_calibration_trial(CalibrationTrialSettings settings);

/// Rows of the key table.
std::vector<KeyRow> calibration_trial_keys();

}  // namespace glint
