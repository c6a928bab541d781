// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/blurred/kept_rays.h"

#include <algorithm>
#include <span>
#include <utility>

#include "simulator/render/path_tracing/render_paths.h"
#include "studies/definition/render_methods.h"

namespace glint {

VisibilityBuffer look_at(const Part& part,
                         const Bvh& bvh,
                         const SurfaceDetail& detail,
                         const PinholeCamera& camera,
                         const RigidTransform& camera_from_world,
                         ThreadPool& pool) {
  constexpr int kRaysPerPixel = 16;
  constexpr double kAnyWavelength_nm = 550.0;
  const SurfaceMaterial material({}, std::span(&kAnyWavelength_nm, 1));
  const Lights none;
  const PhysicalScene scene = {.part = part,
                               .bvh = bvh,
                               .detail = detail,
                               .material = material,
                               .lights = none,
                               .camera = camera,
                               .camera_from_world = camera_from_world};
  Film sums =
      render_paths(scene, {.samples = kRaysPerPixel, .channels = 1, .has_light = false}, pool);
  VisibilityBuffer seen;
  seen.camera = {camera, camera_from_world};
  seen.width_px = sums.width_px;
  seen.height_px = sums.height_px;
  seen.coverage = ImageF(sums.width_px, sums.height_px);
  for (std::size_t i = 0; i < seen.coverage.size(); ++i) {
    const auto rays = static_cast<float>(sums.part.values()[i]);
    seen.coverage.values()[i] = rays / static_cast<float>(sums.samples.values()[i]);
    for (ImageF* place : {&sums.x_mm, &sums.y_mm, &sums.z_mm}) {
      place->values()[i] /= std::max(1.0F, rays);
    }
  }
  seen.seen_x = std::move(sums.x_mm);
  seen.seen_y = std::move(sums.y_mm);
  seen.seen_z = std::move(sums.z_mm);
  return seen;
}

RayCache trace_kept_rays(const SceneSettings& scene,
                         const Part& part,
                         const Bvh& bvh,
                         const SurfaceDetail& detail,
                         const PinholeCamera& camera,
                         const RigidTransform& camera_from_world,
                         ThreadPool& pool) {
  RayCache rays = trace_rays(part, bvh, detail, camera, camera_from_world, scene.render, pool);
  if (is_blurred(scene)) {
    static_cast<VisibilityBuffer&>(rays) =
        look_at(part, bvh, detail, camera, camera_from_world, pool);
  }
  return rays;
}

}  // namespace glint
