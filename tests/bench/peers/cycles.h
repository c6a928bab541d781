// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "studies/definition/scene.h"
#include "tests/bench/peers/results.h"

namespace glint::peers {

struct CyclesSettings {
  int samples_per_pixel = 4;
  bool is_packed = false;  ///< three positions of the scan in red, green and blue of one picture
  int timed_frames = 4;    ///< after the first one
};

/// Renders the first frames of a candidate in Blender's Cycles.
/// @param script cycles.py
/// @param folder holds part.raw and gets the results
/// @throws Error when Blender fails
Result measure_cycles(const SceneSettings& scene,
                      const CyclesSettings& settings,
                      const std::filesystem::path& script,
                      const std::filesystem::path& folder);

}  // namespace glint::peers
