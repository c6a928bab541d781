// SPDX-License-Identifier: GPL-3.0-or-later
//
// The steps of sixteen paths at a time: by kernels in float where these know the scene's kind
// (plane triangles, one metal everywhere), else lane by lane by the functions of material and light
// in double, which are also what tests compare the kernels with. Points on curved exact surfaces
// and near surface detail are always found in double. docs/theory/path_tracing.md, "Packets", has
// the table of what goes which way.
#include "simulator/render/path_tracing/packet_stages.h"

#include <cmath>
#include <limits>
#include <variant>

#include "simulator/render/path_tracing/surface_point.h"

namespace glint {
namespace {

using Eigen::Vector3d;

Vector3d vector_at(const VectorLanes& lanes, std::size_t lane) {
  return {static_cast<double>(lanes.x[lane]),
          static_cast<double>(lanes.y[lane]),
          static_cast<double>(lanes.z[lane])};
}

LocalDirection local_at(const VectorLanes& lanes, std::size_t lane) {
  return {static_cast<double>(lanes.x[lane]),
          static_cast<double>(lanes.y[lane]),
          static_cast<double>(lanes.z[lane])};
}

void set_vector(const Vector3d& from, std::size_t lane, VectorLanes& to) {
  to.x[lane] = static_cast<float>(from.x());
  to.y[lane] = static_cast<float>(from.y());
  to.z[lane] = static_cast<float>(from.z());
}

template <class Colours>
void set_colour(const Colours& from, std::size_t lane, ColourLanes& to) {
  for (std::size_t c = 0; c < 3; ++c) {
    to.c[c][lane] = static_cast<float>(from[static_cast<Eigen::Index>(c)]);
  }
}

Ray ray_at(const RayPacket& rays, std::size_t lane) {
  return {.origin_mm = {static_cast<double>(rays.origin_x[lane]),
                        static_cast<double>(rays.origin_y[lane]),
                        static_cast<double>(rays.origin_z[lane])},
          .direction = {static_cast<double>(rays.direction_x[lane]),
                        static_cast<double>(rays.direction_y[lane]),
                        static_cast<double>(rays.direction_z[lane])}};
}

Hit hit_at(const HitPacket& hits, std::size_t lane) {
  return {.t_mm = hits.t_mm[lane],
          .triangle = hits.triangle[lane],
          .u = hits.u[lane],
          .v = hits.v[lane]};
}

/// Gathers planes and corner normals.
void load(const PathTask& task, const HitPacket& hits, TriangleLanes& to) {
  const TriangleMesh& mesh = task.scene.part.mesh;
  for (std::size_t i = 0; i < kPacketLanes; ++i) {
    if (hits.triangle[i] < 0) {
      set_vector(Vector3d::Zero(), i, to.face);
      to.offset_mm[i] = 0.0F;
      continue;
    }
    const TrianglePlane& plane = task.scene.bvh.plane(hits.triangle[i]);
    set_vector({plane.normal_x, plane.normal_y, plane.normal_z}, i, to.face);
    to.offset_mm[i] = static_cast<float>(plane.offset_mm);
    const auto triangle = static_cast<std::size_t>(hits.triangle[i]);
    for (std::size_t c = 0; c < 3 && task.flat_triangles[triangle] == 0; ++c) {
      set_vector(mesh.normal(triangle, c), i, to.corner[c]);
    }
  }
}

void set_labels(const PhysicalScene& scene, const HitPacket& hits, SurfaceLanes& surface) {
  for (std::size_t i = 0; i < kPacketLanes; ++i) {
    surface.reflectance[i] = 1.0F;
    surface.defect[i] = -1;
    if (hits.triangle[i] >= 0 && !scene.face_labels.empty()) {
      const std::int32_t label = scene.face_labels[static_cast<std::size_t>(hits.triangle[i])];
      surface.defect[i] = label > 0 ? label : -1;
    }
  }
}

}  // namespace

void PacketStages::intersect(const PathPacket& paths, SurfaceLanes& surface) const {
  if (task_.intersects_by_kernel) {
    intersect_triangles(paths, surface);
  }
  const bool has_others = !task_.curved_triangles.empty() || !task_.scene.detail.empty();
  for (std::size_t i = 0; i < kPacketLanes && (has_others || !task_.intersects_by_kernel); ++i) {
    if (paths.hit.triangle[i] >= 0 &&
        (!task_.intersects_by_kernel || needs_double(paths, surface, i))) {
      intersect_lane(paths, i, surface);
    }
  }
  set_open(paths, surface);
}

/// Whether a lane that the kernel has met lies on a curved exact surface, or where detail reaches.
bool PacketStages::needs_double(const PathPacket& paths,
                                const SurfaceLanes& surface,
                                std::size_t lane) const {
  const std::int32_t triangle = paths.hit.triangle[lane];
  if (!task_.curved_triangles.empty() &&
      task_.curved_triangles[static_cast<std::size_t>(triangle)] != 0) {
    return true;
  }
  if (task_.scene.detail.empty()) {
    return false;
  }
  const TrianglePlane& plane = task_.scene.bvh.plane(triangle);
  const Vector3d face(plane.normal_x, plane.normal_y, plane.normal_z);
  const double outside = face.dot(vector_at(surface.side, lane)) < 0.0 ? -1.0 : 1.0;
  return task_.scene.detail
             .sample(vector_at(surface.point, lane), outside * vector_at(surface.normal, lane))
             .feature >= 0;
}

void PacketStages::intersect_triangles(const PathPacket& paths, SurfaceLanes& surface) const {
  TriangleLanes triangles = {};
  load(task_, paths.hit, triangles);
  intersect_triangles16(triangles,
                        task_.lay,
                        static_cast<float>(task_.start_offset_mm),
                        paths.ray,
                        paths.hit,
                        surface);
  set_labels(task_.scene, paths.hit, surface);
}

void PacketStages::intersect_lane(const PathPacket& paths,
                                  std::size_t lane,
                                  SurfaceLanes& surface) const {
  const ShadingPoint point = intersect_surface(
      task_.scene, task_.start_offset_mm, ray_at(paths.ray, lane), hit_at(paths.hit, lane));
  set_vector(point.point_mm, lane, surface.point);
  set_vector(point.start_mm, lane, surface.start);
  set_vector(point.side, lane, surface.side);
  set_vector(point.frame.tangent, lane, surface.tangent);
  set_vector(point.frame.bitangent, lane, surface.bitangent);
  set_vector(point.frame.normal, lane, surface.normal);
  const LocalDirection& viewer = point.to_viewer;
  set_vector({viewer.x, viewer.y, viewer.z}, lane, surface.viewer);
  surface.tilt[lane] = static_cast<float>(1.0 - std::min(1.0, viewer.z));
  surface.reflectance[lane] = static_cast<float>(point.reflectance);
  surface.defect[lane] = point.defect;
}

void PacketStages::set_open(const PathPacket& paths, SurfaceLanes& surface) const {
  if (task_.scene.bvh.is_convex()) {
    surface.open = surface.side;
    return;
  }
  surface.open = {};
  if (task_.is_open.empty()) {
    return;
  }
  for (std::size_t i = 0; i < kPacketLanes; ++i) {
    const std::int32_t triangle = paths.hit.triangle[i];
    if (triangle < 0 || task_.is_open[static_cast<std::size_t>(triangle)] == 0) {
      continue;
    }
    const TrianglePlane& plane = task_.scene.bvh.plane(triangle);
    const Vector3d normal(plane.normal_x, plane.normal_y, plane.normal_z);
    if (normal.dot(vector_at(surface.side, i)) > 0.0) {  // seen from outside
      set_vector(normal, i, surface.open);
    }
  }
}

void PacketStages::hit_lights(const PathPacket& paths,
                              bool is_camera,
                              LightHitLanes& lights) const {
  for (std::size_t i = 0; i < kPacketLanes; ++i) {
    lights.is_hit[i] = 0;
    if (paths.ray.valid[i] != 0) {
      hit_light(paths, i, is_camera, lights);
    }
  }
}

void PacketStages::hit_light(const PathPacket& paths,
                             std::size_t lane,
                             bool is_camera,
                             LightHitLanes& lights) const {
  const Ray ray = ray_at(paths.ray, lane);
  const double reach_mm = paths.hit.triangle[lane] >= 0 ? static_cast<double>(paths.hit.t_mm[lane])
                                                        : std::numeric_limits<double>::infinity();
  const auto light = glint::hit_light(task_.scene.lights, ray, reach_mm);
  if (!light) {
    return;
  }
  const bool has_rival = !is_camera && paths.density[lane] > 0.0F && light->cosine > 0.0;
  lights.is_hit[lane] = 1;
  lights.cosine[lane] = static_cast<float>(light->cosine);
  lights.density[lane] =
      has_rival ? static_cast<float>(light_density(task_.scene.lights, ray, *light)) : 0.0F;
  set_colour(light->radiance, lane, lights.radiance);
  lights.group[lane] = light->group;
}

bool PacketStages::ask_lights(const PathPacket& paths,
                              const SurfaceLanes& surface,
                              const RandomLanes& random,
                              LightLanes& lights) const {
  if (task_.is_mirror) {
    return false;
  }
  for (std::size_t i = 0; i < kPacketLanes; ++i) {
    lights.density[i] = 0.0F;
    if (paths.ray.valid[i] != 0) {
      ask_light(surface, random, i, lights);
    }
  }
  return true;
}

void PacketStages::ask_light(const SurfaceLanes& surface,
                             const RandomLanes& random,
                             std::size_t lane,
                             LightLanes& lights) const {
  const Vector3d start_mm = vector_at(surface.start, lane);
  const auto light = sample_light(task_.scene.lights,
                                  start_mm,
                                  static_cast<double>(random.light_u[lane]),
                                  static_cast<double>(random.light_v[lane]));
  if (!light || !(vector_at(surface.side, lane).dot(light->direction) > 0.0) ||
      is_occluded(task_.scene.lights, start_mm, *light)) {
    return;
  }
  set_vector(light->direction, lane, lights.direction);
  lights.distance[lane] = static_cast<float>(light->distance_mm);
  lights.density[lane] = static_cast<float>(light->density);
  set_colour(light->radiance, lane, lights.radiance);
  lights.group[lane] = light->group;
}

void PacketStages::reflect(const PathPacket& paths,
                           const SurfaceLanes& surface,
                           const RandomLanes& random,
                           const LightLanes* lights,
                           ReflectionLanes& reflection,
                           LeavingLanes& leaving) const {
  if (task_.metal && lights != nullptr) {
    VectorLanes to_light;
    to_local16(surface, lights->direction, to_light);
    LobeLanes lobes;
    choose_lobes16(*task_.metal, surface.viewer, lobes);
    evaluate16(*task_.metal, lobes, surface.viewer, to_light, reflection);
    sample16(*task_.metal, lobes, surface.viewer, random, leaving);
    tint(paths, surface, reflection, leaving);
    return;
  }
  const SurfaceMaterial& material = task_.scene.material;
  for (std::size_t i = 0; i < kPacketLanes; ++i) {
    if (paths.ray.valid[i] == 0) {
      continue;
    }
    if (!material.has_pattern()) {
      reflect_lane(material.plain(), surface, random, lights, i, reflection, leaving);
      continue;
    }
    reflect_lane(
        material.at(point_of_part(surface, i)), surface, random, lights, i, reflection, leaving);
  }
}

Vector3d PacketStages::point_of_part(const SurfaceLanes& surface, std::size_t lane) const {
  const RigidTransform& pose = task_.scene.part.scene_from_part;
  return pose.rotation.transpose() * (vector_at(surface.point, lane) - pose.translation_mm);
}

/// Metal reflects as much more or less of every colour as its pattern says, whatever the angle.
void PacketStages::tint(const PathPacket& paths,
                        const SurfaceLanes& surface,
                        ReflectionLanes& reflection,
                        LeavingLanes& leaving) const {
  const SurfaceMaterial& material = task_.scene.material;
  for (std::size_t i = 0; i < kPacketLanes && material.has_pattern(); ++i) {
    if (paths.ray.valid[i] == 0) {
      continue;
    }
    const Colour colour = material.texel_at(point_of_part(surface, i)).colour;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto factor = static_cast<float>(colour[static_cast<Eigen::Index>(c)]);
      reflection.value.c[c][i] *= factor;
      leaving.weight.c[c][i] *= factor;
    }
  }
}

void PacketStages::reflect_lane(const Material& material,
                                const SurfaceLanes& surface,
                                const RandomLanes& random,
                                const LightLanes* lights,
                                std::size_t lane,
                                ReflectionLanes& reflection,
                                LeavingLanes& leaving) const {
  const LocalDirection viewer = local_at(surface.viewer, lane);
  if (lights != nullptr && lights->density[lane] > 0.0F) {
    const Vector3d direction = vector_at(lights->direction, lane);
    const Reflection towards = evaluate(material,
                                        viewer,
                                        {vector_at(surface.tangent, lane).dot(direction),
                                         vector_at(surface.bitangent, lane).dot(direction),
                                         vector_at(surface.normal, lane).dot(direction)});
    set_colour(towards.value, lane, reflection.value);
    reflection.density[lane] = static_cast<float>(towards.density);
  }
  const auto sampled = sample(material,
                              viewer,
                              {static_cast<double>(random.lobe_u[lane]),
                               static_cast<double>(random.lobe_v[lane]),
                               static_cast<double>(random.choice[lane])});
  if (!sampled) {
    set_colour(Colour::Zero().eval(), lane, leaving.weight);
    return;
  }
  const LocalDirection& to = sampled->to_light;
  set_vector({to.x, to.y, to.z}, lane, leaving.to_light);
  set_colour(sampled->weight, lane, leaving.weight);
  leaving.density[lane] = sampled->is_mirror ? 0.0F : static_cast<float>(sampled->density);
}

}  // namespace glint
