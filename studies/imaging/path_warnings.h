// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a reader of a path-traced picture must know about its lights.
#pragma once

#include <string>
#include <vector>

#include "simulator/render/path_tracing/physical_scene.h"

namespace glint {

/// A light that stands between the camera and the part.
struct HidingLight {
  std::string name;          ///< of its table below [lighting]
  double back_share = 0.0;   ///< of the part in view: behind the light's dark back
  double front_share = 0.0;  ///< of the part in view: behind its luminous side
};

/// The area lights that hide some of the part from the camera, by some ten thousand rays through
/// the middles of pixels. The tunnel's wall is told by view.hidden_share.
std::vector<HidingLight> hiding_lights(const PhysicalScene& scene);

/// A sentence for each of hiding_lights().
std::vector<std::string> hiding_warnings(const PhysicalScene& scene);

/// All sentences: hiding lights, lights too near for their far-field data, files of measured lights
/// that are not read as a whole.
std::vector<std::string> path_warnings(const PhysicalScene& scene);

}  // namespace glint
