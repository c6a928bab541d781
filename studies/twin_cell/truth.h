// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a simulated cell is in truth, and what its user does not know: a scene, and in its table
// [truth] where the camera sits on the flange, where the part lies, and how far the arm's joints
// are from what they tell.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/pose.h"
#include "studies/definition/scene.h"

namespace glint {

/// Keys of [truth]. Rotations are vectors: axis times angle.
struct TruthSettings {
  std::vector<double> camera_position_mm = {0.0, 0.0, 0.0};  ///< of the camera on the flange
  std::vector<double> camera_rotation_rad = {0.0, 0.0, 0.0};
  std::vector<double> scene_position_mm = {0.0, 0.0, 0.0};  ///< of the scene's origin in the base
  std::vector<double> scene_rotation_rad = {0.0, 0.0, 0.0};
  double exposure_s = 0.01;        ///< > 0; at which the scene's sensor.exposure holds
  double position_noise_mm = 0.0;  ///< >= 0; of the flange at each pose, per axis
  double rotation_noise_rad = 0.0;
  int seed = 1;  ///< >= 0
};

void visit_keys(KeyVisitor& keys, TruthSettings& settings);

struct Truth {
  SceneSettings scene;
  TruthSettings settings;

  RigidTransform flange_from_camera() const;
  RigidTransform base_from_scene() const;
};

/// @throws ConfigError with every problem, IoError
Truth read_truth(const std::filesystem::path& file);

/// The rotation about a vector's direction by its length.
RigidTransform pose_of(const std::vector<double>& position_mm,
                       const std::vector<double>& rotation_rad);

}  // namespace glint
