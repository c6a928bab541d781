// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of what rough metal reflects meets the part again: light that blurred reflections take
// as if it came from the tunnel.
#pragma once

#include <span>

#include <Eigen/Core>

#include "simulator/geometry/bvh/bvh.h"
#include "simulator/render/ray_cache/ray_cache.h"

namespace glint {

/// Share of the directions of lobes of width 0.1, the widest of blurred reflections, in which the
/// part stands in the way, over rays spread evenly among these; 0 for a convex part. The same
/// directions in every call: differences come from the part.
/// @param rays  indices into the arrays of the cache; those that see no part are left out
double returning_share(const RayCache& cache,
                       std::span<const std::size_t> rays,
                       const Bvh& bvh,
                       const Eigen::Vector3d& camera_in_world_mm);

/// @param defects  the rays of pixels that see a defect
/// @throws ConfigError "part" or "defects" where more light returns than blurred reflections may
///         be wrong by: 0.002 of all, 0.02 of that of the defects
void check_no_light_returns(const RayCache& cache,
                            std::span<const std::size_t> defects,
                            const Bvh& bvh,
                            const Eigen::Vector3d& camera_in_world_mm);

}  // namespace glint
