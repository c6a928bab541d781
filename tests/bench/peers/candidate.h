// SPDX-License-Identifier: GPL-3.0-or-later
//
// Glint's side of the comparison.
#pragma once

#include "studies/definition/scene.h"
#include "tests/bench/peers/results.h"

namespace glint::peers {

/// Times Glint on one thread, the best of several repeats, and renders its first frame: one row a
/// method, the one that others are compared with first.
std::vector<Result> measure_glint(const SceneSettings& scene, const Part& part, int repeats);

/// The first frame and which pixels lie away from edges of the light, sampled on all threads.
/// @param rays_per_axis rays along each side of a pixel
Reference render_reference(const SceneSettings& scene, const Part& part, int rays_per_axis);

}  // namespace glint::peers
