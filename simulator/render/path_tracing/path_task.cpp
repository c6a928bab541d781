// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/path_tracing/path_task.h"

#include <algorithm>
#include <array>
#include <set>
#include <variant>

#include "core/error.h"
#include "simulator/render/path_tracing/surface_point.h"

namespace glint {
namespace {

/// Whether rays that left nearby points in similar directions still run close to each other.
Coherence coherence_of(const Material& material) {
  constexpr double kNarrow = 0.2;
  if (std::holds_alternative<Mirror>(material)) {
    return Coherence::kCoherentOnce;
  }
  const auto* metal = std::get_if<Conductor>(&material);
  return metal != nullptr && std::max(metal->alpha.x, metal->alpha.y) < kNarrow
             ? Coherence::kCoherentOnce
             : Coherence::kIncoherent;
}

std::vector<std::int32_t> defect_ids(const PhysicalScene& scene) {
  std::set<std::int32_t> ids;
  for (const HeightFeature& feature : scene.detail.features()) {
    ids.insert(feature.id);
  }
  for (const std::int32_t label : scene.face_labels) {
    if (label > 0) {
      ids.insert(label);
    }
  }
  return {ids.begin(), ids.end()};
}

/// An exact plane and its triangles are the same but for rounding.
bool is_plane_of(const TrianglePlane& plane, const ExactPatch& patch) {
  constexpr double kSame = 1e-6;
  const Eigen::Vector3d normal(plane.normal_x, plane.normal_y, plane.normal_z);
  return std::holds_alternative<PlanePatch>(patch.shape) &&
         (patch.scene_from_patch.rotation.col(2) - normal).cwiseAbs().maxCoeff() <= kSame;
}

/// Empty: none is.
std::vector<std::uint8_t> find_curved_triangles(const PhysicalScene& scene,
                                                const std::vector<std::uint8_t>& flat) {
  const TriangleMesh& mesh = scene.part.mesh;
  std::vector<std::uint8_t> curved;
  for (std::size_t i = 0; i < mesh.num_triangles() && !scene.part.patches.empty(); ++i) {
    const std::int32_t patch = mesh.patch_of(i);
    const bool is_curved =
        patch >= 0 &&
        (flat[i] == 0 || !is_plane_of(scene.bvh.plane(static_cast<std::int32_t>(i)),
                                      scene.part.patches[static_cast<std::size_t>(patch)]));
    curved.push_back(is_curved ? 1 : 0);
  }
  return curved;
}

}  // namespace

PathTask::PathTask(const PhysicalScene& the_scene, const PathSettings& the_settings)
    : scene(the_scene),
      settings(the_settings),
      camera(the_scene.camera, the_scene.lens),
      scene_from_camera(inverse(the_scene.camera_from_world)),
      start_offset_mm(glint::start_offset_mm(the_scene.part)),
      bounces(coherence_of(the_scene.material.plain())),
      ids(defect_ids(the_scene)),
      camera_numbers(glint::camera_numbers(the_scene)),
      lay(lay_numbers(the_scene.material, the_scene.part.scene_from_part)),
      is_open(the_scene.bvh.escape_cone(the_scene.part.mesh).is_open),
      flat_triangles(the_scene.bvh.flat_triangles(the_scene.part.mesh)),
      curved_triangles(find_curved_triangles(the_scene, flat_triangles)),
      is_mirror(std::holds_alternative<Mirror>(the_scene.material.plain())) {
  if (!scene.material.varies_roughness()) {
    metal = conductor_numbers(scene.material.plain());
  }
  needs_choice = !metal || metal->columns > 0;
  if (settings.has_light) {
    for (const LightGroup& group : scene.lights.groups) {
      factors.push_back(group.factor);
    }
  }
}

Ray camera_ray(const PathTask& task, const Eigen::Vector2d& pixel_px, const SobolSampler& numbers) {
  const bool is_pinhole = !(task.scene.lens.aperture_mm > 0.0);
  const std::array<double, 2> at =
      is_pinhole ? std::array<double, 2>{0.5, 0.5} : numbers.pair(kLensPair);
  const auto ray = task.camera.sample(pixel_px, {at[0], at[1]});
  GLINT_CHECK(ray.has_value(), "the camera has a ray for every point of its image");
  const RigidTransform& pose = task.scene_from_camera;
  return {.origin_mm = pose * ray->origin_mm, .direction = pose.rotation * ray->direction};
}

}  // namespace glint
