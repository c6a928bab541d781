// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frontier of a scene whose light is found by following paths. The reference pools independent
// batches of samples, with more of them and more reflections than the scene's own settings. Its
// noise is known from their scatter and taken out of every error, and what noise does to its scores
// is taken out of them (pooled_score.h). What random numbers do to a method is seen by rendering it
// several times, too.
#pragma once

#include "studies/frontier/frontier.h"

namespace glint {

/// Most pixels of a picture on the frontier.
inline constexpr double kMaxFrontierPixels = 0.3e6;

/// @throws ConfigError beginning with the key at fault, IoError
Frontier measure_path_frontier(const SceneSettings& scene, const FrontierOptions& options);

}  // namespace glint
