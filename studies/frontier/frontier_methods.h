// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which methods of rendering a frontier compares.
#pragma once

#include <vector>

#include "studies/definition/scene.h"
#include "studies/frontier/frontier_errors.h"

namespace glint {

/// What measure_frontier() will measure, without results; the coarsest sampling comes first.
/// @throws ConfigError for a scene that only path tracing knows
std::vector<FrontierPoint> frontier_methods(const SceneSettings& scene);

/// The scene with half as many pixels of twice the size.
SceneSettings half_resolution(SceneSettings scene);

}  // namespace glint
