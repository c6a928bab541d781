// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pixels of the part a tunnel's wall hides from the camera.
#pragma once

#include <Eigen/Core>

#include "simulator/light/tunnel/tunnel.h"
#include "simulator/render/ray_cache/ray_cache.h"
#include "simulator/render/wall/corner_sights.h"

namespace glint {

/// By the corners of every pixel. @param seen  by a camera that it knows, standing there
OccludedPixels occluded_pixels_one_by_one(const VisibilityBuffer& seen,
                                          const Tunnel& tunnel,
                                          const Eigen::Vector3d& camera_in_world_mm);

/// The same from a coarse grid. A sight line is a ray of the camera, so where it crosses the wall
/// changes smoothly over the picture whatever the part looks like: pixels are only tested one by
/// one where the four corners of their tile differ or cross the wall near a boundary of it.
OccludedPixels occluded_pixels(const VisibilityBuffer& seen,
                               const Tunnel& tunnel,
                               const Eigen::Vector3d& camera_in_world_mm);

}  // namespace glint
