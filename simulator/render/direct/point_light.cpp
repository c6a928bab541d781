// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/direct/point_light.h"

#include <algorithm>

#include "simulator/render/direct/hideable_emitters.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// As the path tracer's: a light is not hidden by what lies this share of its distance before it.
constexpr double kShortOfLight = 1e-5;

Vector3d vector_at(const VectorLanes& lanes, std::size_t lane) {
  return {static_cast<double>(lanes.x[lane]),
          static_cast<double>(lanes.y[lane]),
          static_cast<double>(lanes.z[lane])};
}

Vector3d scene_direction(const DirectPoint& point, const VectorLanes& local, std::size_t lane) {
  const Vector3d v = vector_at(local, lane);
  return v.x() * point.frame.tangent + v.y() * point.frame.bitangent + v.z() * point.frame.normal;
}

Eigen::AlignedBox3d box_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& vertex : mesh.vertices_mm) {
    box.extend(vertex);
  }
  return box;
}

RayPacket shadow_rays(const DirectPoint& point, const LitLanes& lit) {
  RayPacket rays;
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    const Vector3d direction = scene_direction(point, lit.direction, i);
    rays.origin_x[i] = static_cast<float>(point.point_mm.x());
    rays.origin_y[i] = static_cast<float>(point.point_mm.y());
    rays.origin_z[i] = static_cast<float>(point.point_mm.z());
    rays.direction_x[i] = static_cast<float>(direction.x());
    rays.direction_y[i] = static_cast<float>(direction.y());
    rays.direction_z[i] = static_cast<float>(direction.z());
    rays.t_max[i] = lit.distance_mm[i] * static_cast<float>(1.0 - kShortOfLight);
    rays.valid[i] = lit.solid_angle[i] > 0.0F ? -1 : 0;
  }
  return rays;
}

}  // namespace

DirectPoint direct_point(const SurfaceLanes& surface, std::size_t lane) {
  const Vector3d viewer = vector_at(surface.viewer, lane);
  return {.point_mm = vector_at(surface.start, lane),
          .frame = {.tangent = vector_at(surface.tangent, lane),
                    .bitangent = vector_at(surface.bitangent, lane),
                    .normal = vector_at(surface.normal, lane)},
          .to_viewer = {.x = viewer.x(), .y = viewer.y(), .z = viewer.z()},
          .side = vector_at(surface.side, lane)};
}

PointLight::PointLight(const PathTask& task, const DirectSettings& settings)
    : task_(task),
      light_(task.scene.lights, *task.metal, task.settings.channels, settings.tolerance),
      hideable_(hideable_emitters(task.scene.lights, box_of(task.scene.part.mesh))),
      has_hideable_(std::ranges::any_of(hideable_, [](std::uint8_t is) { return is != 0; })) {}

void PointLight::hide(const DirectPoint& point,
                      bool by_part,
                      const PlaceLanes& places,
                      LitLanes& lit) const {
  if (by_part) {
    RayPacket rays = shadow_rays(point, lit);
    task_.scene.bvh.occluded16(rays, Coherence::kIncoherent);
    for (std::size_t i = 0; i < kPacketSize; ++i) {
      lit.solid_angle[i] = rays.valid[i] != 0 ? lit.solid_angle[i] : 0.0F;
    }
  }
  for (std::size_t i = 0; i < kPacketSize && has_hideable_; ++i) {
    const auto emitter = static_cast<std::size_t>(places.emitter[i]);
    if (lit.solid_angle[i] > 0.0F && hideable_[emitter] != 0) {
      const LightSample place = {
          .direction = scene_direction(point, lit.direction, i).normalized(),
          .distance_mm = static_cast<double>(lit.distance_mm[i]) * (1.0 - kShortOfLight)};
      lit.solid_angle[i] =
          is_occluded(task_.scene.lights, point.point_mm, place) ? 0.0F : lit.solid_angle[i];
    }
  }
}

int PointLight::at(const SurfaceLanes& surface,
                   std::size_t lane,
                   DirectLight::Scratch& scratch,
                   std::span<float> radiance) const {
  const DirectPoint point = direct_point(surface, lane);
  const bool is_open = vector_at(surface.open, lane).squaredNorm() > 0.0;
  if (is_open && !has_hideable_) {
    return light_.at(point, {}, scratch, radiance);
  }
  const auto shadows = [&](const DirectPoint& from, const PlaceLanes& places, LitLanes& lit) {
    hide(from, !is_open, places, lit);
  };
  return light_.at(point, shadows, scratch, radiance);
}

}  // namespace glint
