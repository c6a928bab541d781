// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts traced through the corners of their pixels, and whether two such traces are the same.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "simulator/render/corner_rays/corner_rays.h"
#include "simulator/render/ray_cache/packet_tracer.h"
#include "tests/simulator/render/render_fixtures.h"

namespace glint::test {

/// A part under a camera straight above it, traced through the corners of its pixels.
struct CornerBench {
  Part part;
  Bvh bvh;
  SurfaceDetail detail;
  PinholeCamera camera;
  RigidTransform camera_from_world;
  RenderSettings render;
  CornerRays rays;

  CornerBench(const PartSettings& part_settings,
              const CameraSettings& camera_settings,
              std::vector<HeightFeature> features = {},
              int threads = 1,
              const RenderSettings& render_settings = {})
      : part(build_part(part_settings)),
        bvh(part.mesh),
        detail(std::move(features)),
        camera(intrinsics_of(camera_settings)),
        camera_from_world(glint::camera_from_world(default_viewpoint(camera_settings))),
        render(render_settings) {
    ThreadPool pool(threads);
    rays = trace_corner_rays(part, bvh, detail, camera, camera_from_world, render, pool);
  }

  std::int64_t count(PixelKind kind) const { return std::ranges::count(rays.kind.values(), kind); }

  /// One ray through a point of the image, traced for itself.
  EscapePacket trace_at(const Eigen::Vector2d& pixel_px) const {
    CameraPacket packet;
    EscapePacket escapes;
    const CameraRays camera_rays(camera, camera_from_world);
    camera_rays.through(&pixel_px.x(), &pixel_px.y(), 1, packet);
    const TraceScene scene(part, bvh, detail, render);
    PacketTracer(scene).trace(packet, escapes);
    return escapes;
  }
};

inline const CameraSettings kCornerCamera = {
    .width_px = 120, .height_px = 80, .object_pixel_mm = 0.25, .working_distance_mm = 300.0};

inline PartSettings small_strip() {
  return {.shape = PartSettings::Shape::kStrip,
          .length_mm = 60.0,
          .width_mm = 40.0,
          .radius_along_mm = 800.0,
          .radius_across_mm = 80.0};
}

inline HeightFeature dent_at(
    const Part& part, const Bvh& bvh, double x_mm, double y_mm, double sigma_mm) {
  const auto place = place_on_surface(part, bvh, x_mm, y_mm);
  HeightFeature dent;
  dent.label = "dent";
  dent.centre_mm = place->centre_mm;
  dent.u_axis = place->u_axis;
  dent.v_axis = place->v_axis;
  dent.normal = place->normal;
  dent.sigma_mm = sigma_mm;
  dent.height_mm = -0.02 * sigma_mm;
  return dent;
}

inline std::vector<HeightFeature> some_dents(const PartSettings& settings) {
  const Part part = build_part(settings);
  const Bvh bvh(part.mesh);
  std::vector<HeightFeature> dents = {dent_at(part, bvh, -8.0, -4.0, 0.2),
                                      dent_at(part, bvh, 3.1, 2.2, 0.05),
                                      dent_at(part, bvh, 9.03, -5.02, 0.025),
                                      dent_at(part, bvh, 0.0, 6.0, 0.6)};
  for (std::size_t i = 0; i < dents.size(); ++i) {
    dents[i].id = static_cast<int>(i);
  }
  return dents;
}

/// A plate that lies askew in the image and ends inside it.
inline PartSettings askew_plate() {
  return {.shape = PartSettings::Shape::kPlate,
          .length_mm = 20.0,
          .width_mm = 12.0,
          .thickness_mm = 2.0,
          .rotation_rad = {0.1, 0.05, 0.37}};
}

inline bool same_rays(const RayCache& a, const RayCache& b) {
  return a.origin_x == b.origin_x && a.origin_y == b.origin_y && a.origin_z == b.origin_z &&
         a.direction_x == b.direction_x && a.direction_y == b.direction_y &&
         a.direction_z == b.direction_z && a.weight == b.weight &&
         a.counts.camera == b.counts.camera && a.counts.part == b.counts.part &&
         a.counts.followed == b.counts.followed && a.counts.blocked == b.counts.blocked &&
         a.counts.grazing == b.counts.grazing;
}

inline ::testing::AssertionResult same_bytes(const CornerRays& a, const CornerRays& b) {
  if (!(same_rays(a.corners, b.corners) && a.special == b.special && a.kind == b.kind &&
        a.coverage == b.coverage && a.seen_x == b.seen_x && a.seen_y == b.seen_y &&
        a.seen_z == b.seen_z && a.refined.size() == b.refined.size() &&
        a.counts.camera == b.counts.camera && a.counts.part == b.counts.part &&
        a.counts.followed == b.counts.followed && a.counts.blocked == b.counts.blocked &&
        a.counts.grazing == b.counts.grazing)) {
    return ::testing::AssertionFailure() << "corners, kinds, coverage or counts differ";
  }
  for (std::size_t k = 0; k < a.refined.size(); ++k) {
    if (!(a.refined[k].cells_per_axis == b.refined[k].cells_per_axis &&
          a.refined[k].pixels == b.refined[k].pixels &&
          a.refined[k].is_smooth == b.refined[k].is_smooth &&
          a.refined[k].special == b.refined[k].special &&
          same_rays(a.refined[k].rays, b.refined[k].rays))) {
      return ::testing::AssertionFailure() << "group " << k << " differs";
    }
  }
  return ::testing::AssertionSuccess();
}

}  // namespace glint::test
