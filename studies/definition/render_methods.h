// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a scene's method of rendering means for those who do not render: how its frames come about
// and what a closer look at it is.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "studies/definition/scene.h"

namespace glint {

/// How the frames of a scene come about, as scores.json tells it.
struct FrameMethod {
  std::string name;                                  ///< "paths", "sampled" or "integrated"
  std::vector<std::pair<std::string, int>> numbers;  ///< that are told with it
  bool has_closed_mean = false;  ///< a search may take their mean from closed forms instead
};

FrameMethod frame_method(const SceneSettings& scene);

/// The scene for re-scoring a finalist: other noise, every frame, and finer rays.
SceneSettings finer_settings(SceneSettings scene);

}  // namespace glint
