// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which methods of rendering a frontier compares.
#pragma once

#include <vector>

#include "studies/definition/scene.h"
#include "studies/frontier/frontier_errors.h"

namespace glint {

/// What measure_frontier() will measure, without results; the coarsest sampling comes first. With
/// paths no point is the reference.
std::vector<FrontierPoint> frontier_methods(const SceneSettings& scene);

/// The scene as a point has it rendered.
SceneSettings scene_of(const FrontierPoint& point, SceneSettings scene);

/// The sensor without its noise and rounding: what no method of rendering can change.
SceneSettings noiseless(SceneSettings scene);

/// The smallest whole factor by which a picture has at most so many pixels.
int pixel_factor(const CameraSettings& camera, double max_pixels);

}  // namespace glint
