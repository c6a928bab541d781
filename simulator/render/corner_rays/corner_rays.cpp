// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/corner_rays.h"

#include <fmt/format.h>

#include "simulator/render/corner_rays/corner_tracer.h"

namespace glint {
namespace {

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

/// Traces what the plan says and takes the rest from the base.
RetracedRays trace_planned(const TraceScene& scene,
                           const CameraRays& camera,
                           const RefinementNeed& need,
                           const UpdatePlan& plan,
                           const CornerRays* base,
                           CornerRays empty,
                           ThreadPool& pool) {
  RetracedRays retraced = {.rays = std::move(empty)};
  CornerRays& rays = retraced.rays;
  CornerTracer tracer(scene, camera, need, plan, base, rays);
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
  join_groups(groups, rays);
  check_part_is_seen(rays.counts);
  return retraced;
}

}  // namespace

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
  const TraceScene scene(part, bvh, detail, settings);
  const RefinementNeed need(camera, camera_from_world, part, detail);
  const CameraRays camera_rays(camera, camera_from_world);
  return trace_planned(scene,
                       camera_rays,
                       need,
                       UpdatePlan(),
                       nullptr,
                       empty_corner_rays({camera, camera_from_world}),
                       pool)
      .rays;
}

RetracedRays retrace_detail(const CornerRays& without_detail,
                            const Part& part,
                            const Bvh& bvh,
                            const SurfaceDetail& detail,
                            const PinholeCamera& camera,
                            const RigidTransform& camera_from_world,
                            const RenderSettings& settings,
                            ThreadPool& pool) {
  const TraceScene scene(part, bvh, detail, settings);
  const RefinementNeed need(camera, camera_from_world, part, detail);
  const CameraRays camera_rays(camera, camera_from_world);
  return trace_planned(scene,
                       camera_rays,
                       need,
                       UpdatePlan(without_detail, need),
                       &without_detail,
                       empty_corner_rays({camera, camera_from_world}),
                       pool);
}

}  // namespace glint
