// SPDX-License-Identifier: GPL-3.0-or-later
//
// Poses in files: six numbers of a rigid motion target_from_source, and how well they are known.
#pragma once

#include <vector>

#include "core/config/keys.h"
#include "core/pose.h"

namespace glint {

/// Keys of a pose: where the source's origin lies in the target's frame, and how the source is
/// turned there, as axis times angle.
struct PoseSettings {
  std::vector<double> translation_mm = {0.0, 0.0, 0.0};
  std::vector<double> rotation_vector_rad = {0.0, 0.0, 0.0};
};

/// Keys of a pose that was measured.
struct MeasuredPoseSettings {
  PoseSettings pose;
  /// Standard deviations of a small motion in the source's frame along and about its axes,
  /// pose * motion; 0: not known.
  std::vector<double> sigma_mm = {0.0, 0.0, 0.0};
  std::vector<double> sigma_rad = {0.0, 0.0, 0.0};
};

void visit_keys(KeyVisitor& keys, PoseSettings& settings);
void visit_keys(KeyVisitor& keys, MeasuredPoseSettings& settings);

RigidTransform transform_of(const PoseSettings& settings);

/// Inverse of transform_of(), with a rotation of at most 180 degrees.
PoseSettings pose_settings(const RigidTransform& transform);

}  // namespace glint
