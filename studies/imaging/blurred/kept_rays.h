// SPDX-License-Identifier: GPL-3.0-or-later
//
// The rays that a scene keeps, and what of the part its pixels see.
#pragma once

#include "core/thread_pool.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"
#include "simulator/geometry/surface/surface_detail.h"
#include "simulator/render/ray_cache/ray_cache.h"
#include "studies/definition/scene.h"

namespace glint {

/// What the camera sees of the part, by camera rays alone, 16 a pixel: all that scores of
/// path-traced pictures need to know of it.
VisibilityBuffer look_at(const Part& part,
                         const Bvh& bvh,
                         const SurfaceDetail& detail,
                         const PinholeCamera& camera,
                         const RigidTransform& camera_from_world,
                         ThreadPool& pool);

/// The rays of a scene of plain sampling, or of blurred reflections: these look_at() the part as
/// path tracing does, so that scores of both are taken in the same pixels.
/// @throws ConfigError as trace_rays()
RayCache trace_kept_rays(const SceneSettings& scene,
                         const Part& part,
                         const Bvh& bvh,
                         const SurfaceDetail& detail,
                         const PinholeCamera& camera,
                         const RigidTransform& camera_from_world,
                         ThreadPool& pool);

}  // namespace glint
