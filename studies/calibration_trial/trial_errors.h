// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far a calibration is from the truth, which only a simulation knows.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/calibration_trial/trial_poses.h"

namespace glint {

/// Distances between where a point of the board's plane is seen and where the calibration says it
/// is, at poses that were not among the pictures and without errors of the robot.
struct OverlapError {
  double rms_px = 0.0;
  double center_px = 0.0;  ///< rms within 1/6 of the picture's width from its middle
  double edge_px = 0.0;    ///< rms beyond 0.4 of it
};

struct TrialErrors {
  double rotation_rad = 0.0;     ///< of the hand-eye
  double translation_mm = 0.0;   ///< of the hand-eye
  bool is_board_upright = true;  ///< the board's first corner is where it is
  OverlapError overlap;
};

/// Camera, hand-eye and board of a calibration.json. @param calibration  with poses
CameraOnRobot estimate_of(const nlohmann::ordered_json& calibration);

/// @param poses  at least one: told poses, which are taken as the real ones
TrialErrors trial_errors(const CameraOnRobot& truth,
                         const CameraOnRobot& estimate,
                         const std::vector<RigidTransform>& poses);

/// A figure with what it should be at most.
struct TrialGoal {
  std::string name;
  std::string unit;
  double found = 0.0;
  double goal = 0.0;
};

/// For 80 pictures of 2448 x 2050 pixels with errors of 0.05 mm and 0.02 degrees of the robot.
std::vector<TrialGoal> trial_goals(const TrialErrors& errors);

}  // namespace glint
