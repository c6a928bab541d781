// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bundles in which each picture has a free pose of its own.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hardware/calibration/bundle.h"

namespace glint {

/// A picture's view at a pose; all weights one.
BundleView free_view(const BoardCorners& corners, const Eigen::Isometry3d& camera_from_board);

/// A bundle of free poses without limits.
Bundle camera_bundle(const LensVector& lens, const LensMask& is_free);

/// camera_from_board of a view as it stands.
Eigen::Isometry3d pose_of(const Bundle& bundle, const BundleView& view);

/// Weights min(1, (3 sigma / e)^2) of each corner, e its distance from the computed place: within
/// 3 sigma a corner counts fully, beyond it the less the farther off it is.
void weigh_corners(Bundle& bundle);

/// Minimises, estimates the corner noise, weighs the corners; up to `rounds` times, until the noise
/// no longer changes by 0.1 %. False when the minimiser fails.
bool fit_camera(Bundle& bundle, int rounds);

/// The pose that fits one picture best with the intrinsics fixed: {view, rms in px}. Empty when
/// none is found.
struct FittedView {
  BundleView view;
  double rms_px = 0.0;
};

std::optional<FittedView> fit_view(const BoardCorners& corners, const LensVector& lens);

}  // namespace glint
