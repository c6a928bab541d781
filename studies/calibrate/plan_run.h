// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --plan`: from where to photograph the board.
#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "core/config/keys.h"
#include "core/units.h"
#include "studies/definition/study.h"

namespace glint {

enum class PlanMethod { kInformation, kStrided };

/// Keys of --set plan.key=value.
struct PlanSettings {
  PlanMethod method = PlanMethod::kInformation;
  double near_mm = 0.0;  ///< in focus from here
  double far_mm = 0.0;   ///< to here
  double tilt_min_rad = 20.0 * kRadPerDeg;
  double tilt_max_rad = 30.0 * kRadPerDeg;
  double roll_rad = 40.0 * kRadPerDeg;
  double margin_px = 10.0;
  int seed = 1;
};

void visit_keys(KeyVisitor& keys, PlanSettings& settings);

struct PosePlanOptions {
  int count = 20;
  std::filesystem::path board;  ///< empty: that of the calibration
  /// A camera's file, or a calibration.json or its folder: then with the robot's poses.
  std::filesystem::path camera;
  std::filesystem::path out;   ///< empty: out/<name of the camera's file>/plan
  std::vector<KeyValue> sets;  ///< "plan.key=value"
  /// base_from_flange of pictures that a calibration with poses has: the plan adds to what they
  /// tell, with the calibration's errors and unknowns, and keeps to depths a tenth beyond theirs,
  /// or as far as the largest tilt takes the board's corners.
  std::vector<Eigen::Isometry3d> taken;
  double aim_mm = 0.0;  ///< what the hand-eye is to be known to; 0: not asked for
  double aim_deg = 0.0;
};

/// Writes poses.csv, poses.toml, plan.json and run.json. Poses are base_from_flange where the
/// camera is a calibration with a hand-eye, else board_from_camera.
/// @return what plan.json holds, and "folder"
/// @throws ConfigError, IoError; nothing is left behind
nlohmann::ordered_json plan_poses(const PosePlanOptions& options);

}  // namespace glint
