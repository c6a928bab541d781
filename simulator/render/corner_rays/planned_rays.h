// SPDX-License-Identifier: GPL-3.0-or-later
//
// Corner rays of a picture, all of them or those that a plan names.
#pragma once

#include "simulator/render/corner_rays/corner_rays.h"
#include "simulator/render/corner_rays/detail_reach.h"
#include "simulator/render/corner_rays/update_plan.h"
#include "simulator/render/ray_cache/packet_tracer.h"

namespace glint {

/// A picture of which nothing is traced yet.
CornerRays empty_corner_rays(const PlacedCamera& placed);

/// Traces what the plan says and takes the rest from the base.
/// @param base       the same picture without detail; nullptr: the plan is everything
/// @param max_cells  up to which pixels beyond the reach of defects are cut, see affordable_cells.h
/// @throws ConfigError when no ray meets the part
RetracedRays trace_planned(const TraceScene& scene,
                           const PlacedCamera& placed,
                           const RefinementNeed& need,
                           const UpdatePlan& plan,
                           const CornerRays* base,
                           int max_cells,
                           ThreadPool& pool);

}  // namespace glint
