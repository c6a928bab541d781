// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "simulator/light/tunnel/tunnel_settings.h"
#include "simulator/render/footprint/visible_part.h"
#include "simulator/render/ray_cache/ray_cache.h"

namespace glint {

/// Takes the light from rays that the wall stops on their way to the camera.
/// @param gain  of each ray, as WallRays::gain
void hide_rays(const OccludedPixels& occluded,
               const TunnelSettings& tunnel,
               const RayCache& cache,
               std::span<float> gain);

}  // namespace glint
