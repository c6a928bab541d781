// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/physical/path_task.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <variant>

#include "core/error.h"
#include "core/units.h"
#include "simulator/render/physical/surface_point.h"

namespace glint {
namespace {

using Eigen::Vector3d;

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

/// A point of the unit disc, uniform. Source: P. Shirley, K. Chiu, JGT 2(3), 1997.
Eigen::Vector2d point_of_disc(const std::array<double, 2>& random) {
  const double a = 2.0 * random[0] - 1.0;
  const double b = 2.0 * random[1] - 1.0;
  if (a == 0.0 && b == 0.0) {
    return Eigen::Vector2d::Zero();
  }
  const bool is_wide = std::abs(a) > std::abs(b);
  const double radius = is_wide ? a : b;
  const double phi_rad = is_wide ? kPi / 4.0 * (b / a) : kPi / 2.0 - kPi / 4.0 * (a / b);
  return {radius * std::cos(phi_rad), radius * std::sin(phi_rad)};
}

}  // namespace

PathTask::PathTask(const PhysicalScene& the_scene, const PathSettings& the_settings)
    : scene(the_scene),
      settings(the_settings),
      scene_from_camera(inverse(the_scene.camera_from_world)),
      start_offset_mm(glint::start_offset_mm(the_scene.part)),
      bounces(coherence_of(the_scene.material.plain())),
      ids(defect_ids(the_scene)) {
  if (settings.has_light) {
    for (const LightGroup& group : scene.lights.groups) {
      factors.push_back(group.factor);
    }
  }
}

Ray camera_ray(const PathTask& task,
               const Eigen::Vector2d& pixel_px,
               const SampleNumbers& numbers) {
  const auto direction = task.scene.camera.ray_through(pixel_px);
  GLINT_CHECK(direction.has_value(), "the camera has a ray for every point of its image");
  const RigidTransform& pose = task.scene_from_camera;
  const ThinLens& lens = task.scene.lens;
  if (!(lens.radius_mm > 0.0)) {
    return {.origin_mm = pose.translation_mm, .direction = pose.rotation * *direction};
  }
  const Eigen::Vector2d at = lens.radius_mm * point_of_disc(numbers.pair(kLensPair));
  const Vector3d origin_mm(at.x(), at.y(), 0.0);
  const Vector3d sharp_mm = *direction * (lens.focus_mm / direction->z());
  return {.origin_mm = pose * origin_mm,
          .direction = pose.rotation * (sharp_mm - origin_mm).normalized()};
}

}  // namespace glint
