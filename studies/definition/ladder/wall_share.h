// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much light goes from the part to a tunnel's wall and back, roughly: no way to render shows
// it.
#pragma once

#include <Eigen/Core>

#include "studies/definition/scene.h"

namespace glint {

struct WallShare {
  double wall_mm2 = 0.0;  ///< the luminous wall, the slot left out
  double returned = 0.0;  ///< of the light that leaves the part's face: falls on it again if the
                          ///< wall reflects all of it
};

/// Of a Lambertian face as large as the part is along x and y, in the middle of the part and turned
/// to the camera, and of a Lambertian wall: form factors from places of the face to pieces of the
/// wall, and back by reciprocity. A long tunnel returns little from its far ends, so this is more
/// than the part's share of the wall: of a small face of area A in the axis of a long semicylinder
/// of radius r 5/32 A / r^2.
/// @param scene    with a tunnel
/// @param size_mm  of the part
WallShare wall_share(const SceneSettings& scene, const Eigen::Vector3d& size_mm);

}  // namespace glint
