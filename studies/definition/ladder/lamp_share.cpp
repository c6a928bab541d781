// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/lamp_share.h"

#include <algorithm>
#include <iterator>
#include <variant>
#include <vector>

#include "core/pose.h"
#include "core/units.h"
#include "simulator/camera/camera_settings.h"
#include "simulator/geometry/part/part.h"

namespace glint {
namespace {

/// The middle of the part's face that is turned to the camera.
struct PartFace {
  Eigen::Vector3d middle_mm;
  Eigen::Vector3d normal;
};

/// From an element of the face to the lamp's front, in [0, 1].
double form_factor(const PartFace& face, const EmitterShape& shape) {
  constexpr int kSteps = 16;  // along both parameters
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const ShapePoint at = point_on(shape, (i + 0.5) / kSteps, (j + 0.5) / kSteps);
      const Eigen::Vector3d way = at.point_mm - face.middle_mm;
      const double square = way.squaredNorm();
      const double leaving = std::max(0.0, face.normal.dot(way));
      const double arriving = std::max(0.0, -at.normal.dot(way));
      sum += square > 0.0 ? leaving * arriving / (square * square) : 0.0;
    }
  }
  return std::min(1.0, sum / (kSteps * kSteps) * area_mm2(shape) / kPi);
}

std::vector<NamedLight> lamps_with_surface(const SceneSettings& scene, bool has_loader) {
  std::vector<NamedLight> lamps;
  std::ranges::copy_if(scene.lights, std::back_inserter(lamps), [&](const NamedLight& light) {
    return !is_surrounding(light.settings) &&
           (has_loader || !std::holds_alternative<MeshLightSettings>(light.settings));
  });
  return lamps;
}

}  // namespace

LampShare lamp_share(const SceneSettings& scene,
                     const Eigen::Vector3d& size_mm,
                     const MeshLoader& load_mesh) {
  const LightMounts mounts = {
      .scene_from_camera = inverse(camera_from_world(scene.viewpoint())),
      .scene_from_part =
          pose_from_angles(vector_of(scene.part.position_mm), vector_of(scene.part.rotation_rad))};
  const Eigen::Vector3d middle_mm = mounts.scene_from_part.translation_mm;
  const PartFace face = {
      .middle_mm = middle_mm,
      .normal = (mounts.scene_from_camera.translation_mm - middle_mm).normalized()};
  const double face_mm2 = size_mm.x() * size_mm.y();
  LampShare share;
  const Lights lights =
      build_lights(lamps_with_surface(scene, static_cast<bool>(load_mesh)), mounts, load_mesh);
  for (const Emitter& lamp : lights.emitters) {
    const double seen = form_factor(face, lamp.shape);
    share.seen += seen;
    share.returned += seen * std::min(1.0, seen * face_mm2 / area_mm2(lamp.shape));
  }
  share.seen = std::min(1.0, share.seen);
  return share;
}

}  // namespace glint
