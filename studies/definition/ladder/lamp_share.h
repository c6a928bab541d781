// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much light goes from the part to the lamps and back, roughly: no way to render shows it.
#pragma once

#include <Eigen/Core>

#include "simulator/light/area/build_lights.h"
#include "studies/definition/scene.h"

namespace glint {

struct LampShare {
  double seen = 0.0;      ///< share of what the part's face sees that lamps fill, by their fronts
  double returned = 0.0;  ///< of the light that leaves the face: falls on it again if lamps reflect
                          ///< all of it
};

/// Of a Lambertian face as large as the part is along x and y, in the middle of the part and turned
/// to the camera, and of Lambertian lamps: form factors from the face's middle, and back by
/// reciprocity. What stands in between does not count. An environment and lamps from mesh files
/// without a loader are left out.
/// @param size_mm  of the part
LampShare lamp_share(const SceneSettings& scene,
                     const Eigen::Vector3d& size_mm,
                     const MeshLoader& load_mesh);

}  // namespace glint
