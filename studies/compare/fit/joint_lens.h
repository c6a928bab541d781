// SPDX-License-Identifier: GPL-3.0-or-later
//
// One lens for several views of a camera, each with a pose of its own.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "studies/compare/fit/cause_fit.h"

namespace glint {

/// What a view says by itself.
struct LensView {
  std::vector<SpaceEdge> edges;
  Eigen::Vector3d middle_mm = Eigen::Vector3d::UnitZ();  ///< about which the part turns
  CauseVector changes = {};                              ///< where the fit begins
  double noise_px = 1.0;                                 ///< of a single offset
};

/// Fits the lens to all views together and the pose of the part to each, robustly (Ceres): what a
/// view cannot tell of its lens, as distance against focal length, the others may.
/// @param lens  of the camera's own parameters those that may change; the others stay
/// @return the changes of each view, those of the camera the same in all
std::vector<CauseVector> fit_joint_lens(std::span<const LensView> views,
                                        const PinholeIntrinsics& camera,
                                        std::span<const CauseParameter> lens);

}  // namespace glint
