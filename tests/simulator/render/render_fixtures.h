// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "simulator/camera/camera_settings.h"
#include "simulator/render/scan/scan.h"

namespace glint::test {

/// A part under a camera straight above it, traced.
struct Bench {
  Part part;
  Bvh bvh;
  SurfaceDetail detail;
  CameraSettings camera_settings;
  RenderSettings render;
  Eigen::Vector3d camera_mm;
  RayCache rays;

  Bench(const PartSettings& part_settings,
        const CameraSettings& camera,
        const RenderSettings& render_settings,
        std::vector<HeightFeature> features = {},
        int threads = 1)
      : Bench(build_part(part_settings), camera, render_settings, std::move(features), threads) {}

  Bench(Part built,
        const CameraSettings& camera,
        const RenderSettings& render_settings,
        std::vector<HeightFeature> features = {},
        int threads = 1)
      : part(std::move(built)),
        bvh(part.mesh),
        detail(std::move(features)),
        camera_settings(camera),
        render(render_settings),
        camera_mm(0.0, 0.0, camera.working_distance_mm) {
    ThreadPool pool(threads);
    rays = trace_rays(part,
                      bvh,
                      detail,
                      PinholeCamera(intrinsics_of(camera)),
                      camera_from_world(default_viewpoint(camera)),
                      render,
                      pool);
  }
};

/// A flat polished plate of 60 x 40 mm whose top is at z = 1 mm.
inline PartSettings plate() {
  return {.shape = PartSettings::Shape::kPlate,
          .length_mm = 60.0,
          .width_mm = 40.0,
          .thickness_mm = 2.0};
}

inline constexpr double kPlateTop_mm = 1.0;

/// A camera so far away that its rays are parallel to 1e-4 over a defect.
inline CameraSettings far_camera(int width_px, int height_px, double pixel_mm) {
  return {.width_px = width_px,
          .height_px = height_px,
          .object_pixel_mm = pixel_mm,
          .working_distance_mm = 1e5};
}

/// A luminous ceiling at a distance above the plate; the camera looks through it.
inline TunnelSettings ceiling(double distance_mm, double period_mm) {
  return {.shape = TunnelSettings::Shape::kFlat,
          .base_mm = kPlateTop_mm + distance_mm,
          .distance_mm = 900.0,
          .opening_rad = 180.0 * kRadPerDeg,
          .panel_height_mm = 1000.0,
          .length_mm = 2000.0,
          .slot_mm = 0.0,
          .period_mm = period_mm,
          .blocks_view = false};
}

/// A bump in the middle of the plate with the given steepest slope; 0.8 mm across.
inline HeightFeature bump(double max_slope_rad) {
  HeightFeature feature;
  feature.label = "bump";
  feature.centre_mm = {0.0, 0.0, kPlateTop_mm};
  feature.sigma_mm = 0.2;
  feature.height_mm = max_slope_rad * feature.sigma_mm * std::sqrt(std::exp(1.0));
  return feature;
}

}  // namespace glint::test
