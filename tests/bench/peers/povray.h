// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "studies/definition/scene.h"
#include "tests/bench/peers/results.h"

namespace glint::peers {

/// POV-Ray's anti-aliasing: method 1, never jittered.
struct PovraySettings {
  std::string name;        ///< of files and rows
  double threshold = 0.0;  ///< +A: 0 takes the extra rays in every pixel
  int depth = 2;           ///< +R: depth^2 extra rays
  int timed_frames = 2;
};

/// Renders the first frames of a candidate in POV-Ray, one process each, as it keeps nothing
/// between frames. The second row is what tracing alone takes.
/// @param folder holds part.inc and gets the results
/// @throws Error when POV-Ray fails
std::vector<Result> measure_povray(const SceneSettings& scene,
                                   const PovraySettings& settings,
                                   const std::filesystem::path& folder);

}  // namespace glint::peers
