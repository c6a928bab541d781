// SPDX-License-Identifier: GPL-3.0-or-later
//
// Camera, hand-eye, board and robot errors together, and whether a picture agrees with them.
#pragma once

#include "hardware/calibration/bundle.h"
#include "hardware/calibration/robust_hand_eye.h"
#include "hardware/calibration/variance_components.h"

namespace glint {

/// A picture's view in a joint bundle; all weights one.
BundleView joint_view(const BoardCorners& corners, const Eigen::Isometry3d& base_from_flange);

/// The corners of a board that was taken for itself turned around.
BoardCorners turned_corners(const BoardCorners& corners, const BoardSymmetry& symmetry, int turn);

/// Minimises, estimates all noise sizes, weighs the corners; until no size changes by 0.1 %, at
/// most `rounds` times. False when the minimiser fails; *estimated is then as far as it came.
/// @param estimated  not null: receives the noise of the bundle and how well it is known
bool fit_joint(Bundle& bundle, int rounds, EstimatedNoise* estimated);

/// How a picture agrees with a calibration.
struct Agreement {
  int turn = 0;             ///< of the board that agrees best
  double chi_square = 0.0;  ///< of the six numbers of the robot's error; infinite: not at all
  Vector6d error = Vector6d::Zero();  ///< most likely error of the robot's pose, rad and mm
  double rms_px = 0.0;                ///< with that error
};

/// Tries all turns of the board with the bundle's shared unknowns fixed. With the right turn and
/// noise sizes chi_square is distributed as such with 6 degrees of freedom.
Agreement agreement_of(const Bundle& bundle,
                       const BoardCorners& corners,
                       const Eigen::Isometry3d& base_from_flange,
                       const BoardSymmetry& symmetry);

}  // namespace glint
