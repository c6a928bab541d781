// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/planned_rays.h"

#include <utility>

#include "simulator/render/corner_rays/corner_tracer.h"

namespace glint {

CornerRays empty_corner_rays(const PlacedCamera& placed) {
  const PinholeIntrinsics& in = placed.camera.intrinsics();
  CornerRays result;
  result.camera = placed;
  result.width_px = in.width_px;
  result.height_px = in.height_px;
  for (ImageF* image : {&result.coverage, &result.seen_x, &result.seen_y, &result.seen_z}) {
    *image = ImageF(in.width_px, in.height_px);
  }
  result.kind = Image<PixelKind>(in.width_px, in.height_px, PixelKind::kDark);
  return result;
}

RetracedRays trace_planned(const TraceScene& scene,
                           const PlacedCamera& placed,
                           const RefinementNeed& need,
                           const UpdatePlan& plan,
                           const CornerRays* base,
                           int max_cells,
                           ThreadPool& pool) {
  RetracedRays retraced = {.rays = empty_corner_rays(placed)};
  CornerRays& rays = retraced.rays;
  const CameraRays camera(placed.camera, placed.camera_from_world);
  CornerTracer tracer(scene, camera, need, plan, base, max_cells, rays);
  RayCounts counts;
  for (const CornerRow& row : pool.map<CornerRow>(rays.height_px + 1, [&](std::int64_t y) {
         return tracer.trace_corners(static_cast<int>(y));
       })) {
    counts += row.counts;
    retraced.traced += row.traced;
  }
  auto rows = pool.map<CornerRow>(
      rays.height_px, [&](std::int64_t y) { return tracer.refine(static_cast<int>(y)); });
  tracer.finish();
  rays.corners.counts = counts;
  rays.counts = counts;
  std::vector<RowGroups> groups;
  for (CornerRow& row : rows) {
    retraced.traced += row.traced;
    groups.push_back(std::move(row.groups));
  }
  join_groups(std::move(groups), rays);
  check_part_is_seen(rays.counts);
  return retraced;
}

}  // namespace glint
