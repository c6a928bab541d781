// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cost: as the camera rays of path tracing, some 0.3 us a ray.
#include "simulator/render/direct/pixel_rays.h"

#include <algorithm>
#include <limits>

namespace glint {
namespace {

constexpr std::size_t kLanes = kPacketSize;

/// Where a ray of the grid passes through the picture.
Eigen::Vector2d place_px(const RayArea& area, std::size_t ray) {
  const auto width = static_cast<std::size_t>(area.width());
  const std::size_t row = ray / width;
  return {area.x_px + (static_cast<double>(ray % width) + 0.5) / area.per_axis,
          area.y_px + (static_cast<double>(row) + 0.5) / area.per_axis};
}

void set_ray(const Ray& ray, std::size_t lane, RayPacket& rays) {
  rays.origin_x[lane] = static_cast<float>(ray.origin_mm.x());
  rays.origin_y[lane] = static_cast<float>(ray.origin_mm.y());
  rays.origin_z[lane] = static_cast<float>(ray.origin_mm.z());
  rays.direction_x[lane] = static_cast<float>(ray.direction.x());
  rays.direction_y[lane] = static_cast<float>(ray.direction.y());
  rays.direction_z[lane] = static_cast<float>(ray.direction.z());
}

void aim(const PathTask& task, const RayArea& area, std::size_t first, PathPacket& packet) {
  const PinholeIntrinsics& in = task.scene.camera.intrinsics();
  const auto size = static_cast<std::size_t>(area.size());
  CameraLanes lanes = {};
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Eigen::Vector2d at = place_px(area, std::min(first + i, size - 1));
    packet.ray.valid[i] = first + i < size ? -1 : 0;
    if (task.camera_numbers) {
      lanes.column[i] = static_cast<float>((at.x() - in.center_px.x()) / in.focal_px.x());
      lanes.row[i] = static_cast<float>((at.y() - in.center_px.y()) / in.focal_px.y());
    } else {
      set_ray(camera_ray(task, at, {}), i, packet.ray);
    }
  }
  if (task.camera_numbers) {
    camera_rays16(*task.camera_numbers, lanes, packet.ray);
  }
}

RayEnd end_of(const PathPacket& packet, const LightHitLanes& lights, std::size_t lane) {
  if (lights.is_hit[lane] != 0) {
    return RayEnd::kLight;
  }
  return packet.hit.triangle[lane] >= 0 ? RayEnd::kPart : RayEnd::kNothing;
}

}  // namespace

void trace_pixels(const PathTask& task, const RayArea& area, PixelRays& grid) {
  const auto size = static_cast<std::size_t>(area.size());
  const std::size_t packets = (size + kLanes - 1) / kLanes;
  const PacketStages stages(task);
  grid.area = area;
  grid.surfaces.resize(std::max(grid.surfaces.size(), packets));
  grid.lights.resize(std::max(grid.lights.size(), packets));
  grid.ends.resize(packets * kLanes);
  PathPacket packet = {};
  for (std::size_t p = 0; p < packets; ++p) {
    packet.ray.t_max.fill(std::numeric_limits<float>::infinity());
    aim(task, area, p * kLanes, packet);
    task.scene.bvh.intersect16(packet.ray, packet.hit, Coherence::kCoherent);
    stages.hit_lights(packet, true, grid.lights[p]);
    for (std::size_t i = 0; i < kLanes; ++i) {
      grid.ends[p * kLanes + i] = end_of(packet, grid.lights[p], i);
    }
    if (std::ranges::any_of(packet.hit.triangle, [](std::int32_t t) { return t >= 0; })) {
      stages.intersect(packet, grid.surfaces[p]);
    }
  }
}

}  // namespace glint
