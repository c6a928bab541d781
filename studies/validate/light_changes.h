// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a refit may change in how a design is lit, and scenes with these changes put in.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "studies/definition/scene.h"

namespace glint {

/// A light that shines, or whose body stands in the way of others.
struct LitLight {
  std::string name;
  int segments = 1;       ///< that have powers of their own
  bool can_move = false;  ///< has a place
};

/// Changes of one light.
struct LightChange {
  std::string name;
  Eigen::Vector3d moved_mm = Eigen::Vector3d::Zero();  ///< in the frame that it is fixed to
  std::vector<double> segment_power;                   ///< factor of each; empty: all 1
};

struct SceneChange {
  double exposure = 1.0;   ///< factor
  double roughness = 1.0;  ///< factor
  double blur_px2 = 0.0;   ///< added to the square of the blur
  std::vector<LightChange> lights = {};
};

/// The lights of a scene that are not off or have a body that shades others, but for tunnels and
/// environments.
std::vector<LitLight> lights_with_bodies(const SceneSettings& scene);

/// The scene with its segmented lights as groups of their own.
SceneSettings with_separate_segments(SceneSettings scene);

/// The scene after the changes; lights that it does not have are ignored.
SceneSettings changed_scene(SceneSettings scene, const SceneChange& change);

}  // namespace glint
