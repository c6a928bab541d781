// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rays prepared for walls that are surfaces of revolution about the scan axis: the semicylinder of
// any radius about one base line. Five floats a ray (20 bytes) instead of six: with h the ray's
// signed distance from the axis in the y-z plane and (ey, ez) its direction there, it leaves a
// cylinder of radius R after s = sqrt(R^2 - h^2) from its foot,
//
//     x = a + m s,   y = h ez + s ey,   z = -h ey + s ez.
#pragma once

#include "simulator/render/ray_cache/ray_cache.h"
#include "simulator/render/wall/wall_hits.h"

namespace glint {

struct RevolvedRays {
  double base_mm = 0.0;
  FloatArray a_mm, m, h_mm, ey, ez;  ///< ey = ez = 0: along the axis, meets nothing

  std::size_t bytes() const { return 5 * sizeof(float) * a_mm.size(); }
};

/// Whether a tunnel can be met with them: a semicylinder with straight stripes, no cosine law.
bool is_revolved(const TunnelSettings& tunnel);

RevolvedRays revolve(const RayCache& rays, double base_mm);

/// meet_light() for a tunnel that is_revolved() about the same base line; to 1e-3 mm the same.
WallHits meet_revolved(const RevolvedRays& rays, const Tunnel& tunnel);

}  // namespace glint
