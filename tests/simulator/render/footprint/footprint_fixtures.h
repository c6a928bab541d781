// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "core/rng.h"
#include "core/units.h"
#include "simulator/camera/camera_settings.h"
#include "simulator/render/footprint/footprint_frames.h"
#include "simulator/render/scan/closed_scan.h"
#include "simulator/render/scan/scan.h"

namespace glint::test {

/// Straight above, the picture turned by 0.3 rad: edges along its rows or columns would all cross a
/// grid of samples at once, and the samples would be a poor truth.
inline Viewpoint turned_viewpoint(const CameraSettings& camera_settings, double turn_rad = 0.3) {
  Viewpoint viewpoint = default_viewpoint(camera_settings);
  viewpoint.up = {std::sin(turn_rad), std::cos(turn_rad), 0.0};
  return viewpoint;
}

/// A part under a camera straight above it: its corner rays, and point samples where wanted.
struct FootprintBench {
  Part part;
  Bvh bvh;
  SurfaceDetail detail;
  PinholeCamera camera;
  RigidTransform camera_from_world;
  Eigen::Vector3d camera_mm;
  RenderSettings render;
  CornerRays rays;

  FootprintBench(const PartSettings& part_settings,
                 const CameraSettings& camera_settings,
                 double dent_sigma_mm = 0.0,
                 const RenderSettings& render_settings = {},
                 double turn_rad = 0.3)
      : part(build_part(part_settings)),
        bvh(part.mesh),
        detail(dents(dent_sigma_mm)),
        camera(intrinsics_of(camera_settings)),
        camera_from_world(glint::camera_from_world(turned_viewpoint(camera_settings, turn_rad))),
        camera_mm(0.0, 0.0, camera_settings.working_distance_mm),
        render(render_settings) {
    ThreadPool pool(1);
    rays = trace_corner_rays(part, bvh, detail, camera, camera_from_world, render, pool);
  }

  RayCache sampled(int rays_per_axis) const {
    ThreadPool pool(1);
    RenderSettings plain = render;
    plain.rays_per_axis = rays_per_axis;
    return trace_rays(part, bvh, detail, camera, camera_from_world, plain, pool);
  }

 private:
  /// One dent beside the middle, its steepest slope 12 mrad.
  std::vector<HeightFeature> dents(double sigma_mm) const {
    const auto place = place_on_surface(part, bvh, 3.0, 1.5);
    if (sigma_mm <= 0.0 || !place) {
      return {};
    }
    HeightFeature dent;
    dent.label = "dent";
    dent.centre_mm = place->centre_mm;
    dent.u_axis = place->u_axis;
    dent.v_axis = place->v_axis;
    dent.normal = place->normal;
    dent.sigma_mm = sigma_mm;
    dent.height_mm = -0.02 * sigma_mm;
    return {dent};
  }
};

/// 46 x 18 mm, curved both ways: nearly fills a picture of 200 x 100 pixels of 0.25 mm.
inline PartSettings bench_strip() {
  return {.shape = PartSettings::Shape::kStrip,
          .length_mm = 46.0,
          .width_mm = 18.0,
          .radius_along_mm = 400.0,
          .radius_across_mm = 40.0,
          .thickness_mm = 3.0};
}

inline CameraSettings bench_camera() {
  return {.width_px = 200, .height_px = 100, .object_pixel_mm = 0.25, .working_distance_mm = 300.0};
}

/// A tunnel long enough for the strip, with a slot that is mirrored in it.
inline TunnelSettings bench_tunnel() {
  return {.shape = TunnelSettings::Shape::kSemicylinder,
          .radius_mm = 100.0,
          .length_mm = 600.0,
          .slot_mm = 16.0,
          .period_mm = 12.0};
}

/// All frames of a scan, integrated.
inline std::vector<ImageF> integrated_frames(const Footprints& footprints) {
  const CornerRays& rays = footprints.rays();
  const Spans all = whole_image(rays.width_px, rays.height_px);
  std::vector<ImageF> frames(static_cast<std::size_t>(footprints.positions().frames()),
                             ImageF(rays.width_px, rays.height_px));
  FootprintFrames(footprints, all).render(0, frames);
  return frames;
}

}  // namespace glint::test
