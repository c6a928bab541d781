// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/corner_rays.h"

#include <fmt/format.h>

#include "simulator/render/corner_rays/affordable_cells.h"
#include "simulator/render/corner_rays/planned_rays.h"

namespace glint {

CornerRays trace_corner_rays(const Part& part,
                             const Bvh& bvh,
                             const SurfaceDetail& detail,
                             const PinholeCamera& camera,
                             const RigidTransform& camera_from_world,
                             const RenderSettings& settings,
                             ThreadPool& pool) {
  const PinholeIntrinsics& in = camera.intrinsics();
  check_ray_memory((in.width_px + 1.0) * (in.height_px + 1.0),
                   fmt::format("camera.width_px: {} x {} px", in.width_px, in.height_px));
  const PlacedCamera placed = {camera, camera_from_world};
  const TraceScene scene(part, bvh, detail, settings);
  const RefinementNeed need(camera, camera_from_world, part, detail);
  const int max_cells = affordable_cells(part, bvh, placed, need, settings, pool);
  return trace_planned(scene, placed, need, UpdatePlan(), nullptr, max_cells, pool).rays;
}

RetracedRays retrace_detail(const CornerRays& without_detail,
                            const Part& part,
                            const Bvh& bvh,
                            const SurfaceDetail& detail,
                            const PlacedCamera& placed,
                            const RenderSettings& settings,
                            ThreadPool& pool) {
  const TraceScene scene(part, bvh, detail, settings);
  const RefinementNeed need(placed.camera, placed.camera_from_world, part, detail);
  return trace_planned(scene,
                       placed,
                       need,
                       UpdatePlan(without_detail, need),
                       &without_detail,
                       max_cells_of(without_detail),
                       pool);
}

}  // namespace glint
