// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/path_warnings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

namespace glint {
namespace {

/// Points of the part, at most some thousand.
std::vector<Eigen::Vector3d> points_of(const Part& part) {
  constexpr std::size_t kMax = 2000;
  const auto& vertices = part.mesh.vertices_mm;
  const std::size_t step = vertices.size() / kMax + 1;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < vertices.size(); i += step) {
    points.push_back(vertices[i]);
  }
  return points;
}

/// "ring" of "ring" and of "ring.3", the group of a segment.
std::string light_of_group(const std::string& group) {
  const auto dot = group.rfind('.');
  const bool is_segment = dot != std::string::npos && dot + 1 < group.size() &&
                          group.find_first_not_of("0123456789", dot + 1) == std::string::npos;
  return is_segment ? group.substr(0, dot) : group;
}

/// What the camera sees through a point of the picture: whether the part, and a light before it.
struct PixelView {
  bool is_part = false;           ///< the ray goes to the part
  std::optional<LightHit> light;  ///< that it meets before
};

PixelView look_through(const PhysicalScene& scene,
                       const RigidTransform& scene_from_camera,
                       const Eigen::Vector2d& pixel_px) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto in_camera = scene.camera.ray_through(pixel_px);
  if (!in_camera) {
    return {};
  }
  const Ray ray = {.origin_mm = scene_from_camera.translation_mm,
                   .direction = scene_from_camera.rotation * *in_camera};
  const Hit hit = scene.bvh.intersect(ray.origin_mm, ray.direction, 0.0, kInfinity);
  if (!hit) {
    return {};
  }
  std::optional<LightHit> light = hit_light(scene.lights, ray, static_cast<double>(hit.t_mm));
  if (light && (light->emitter == kEnvironment || scene.lights.is_of_wall(light->group))) {
    light.reset();
  }
  return {.is_part = true, .light = light};
}

HidingLight& entry_of(std::vector<HidingLight>& lights, const std::string& name) {
  const auto found = std::ranges::find(lights, name, &HidingLight::name);
  return found != lights.end() ? *found : lights.emplace_back(HidingLight{.name = name});
}

}  // namespace

std::vector<HidingLight> hiding_lights(const PhysicalScene& scene) {
  constexpr int kRaysPerSide = 100;
  const PinholeIntrinsics& in = scene.camera.intrinsics();
  const int step = std::max(1, std::max(in.width_px, in.height_px) / kRaysPerSide);
  const RigidTransform scene_from_camera = inverse(scene.camera_from_world);
  std::vector<HidingLight> hiding;
  int on_part = 0;
  for (int y = step / 2; y < in.height_px; y += step) {
    for (int x = step / 2; x < in.width_px; x += step) {
      const PixelView seen = look_through(scene, scene_from_camera, {x + 0.5, y + 0.5});
      on_part += seen.is_part ? 1 : 0;
      if (seen.light) {
        const auto group = static_cast<std::size_t>(seen.light->group);
        HidingLight& light = entry_of(hiding, light_of_group(scene.lights.groups[group].name));
        (seen.light->cosine > 0.0 ? light.front_share : light.back_share) += 1.0;
      }
    }
  }
  for (HidingLight& light : hiding) {
    light.back_share /= on_part;
    light.front_share /= on_part;
  }
  return hiding;
}

std::vector<std::string> hiding_warnings(const PhysicalScene& scene) {
  std::vector<std::string> warnings;
  for (const HidingLight& light : hiding_lights(scene)) {
    if (light.back_share > 0.0) {
      warnings.push_back(
          fmt::format("The back of lighting.{} hides {:.1f} % of the part from the camera: the "
                      "picture is dark there.",
                      light.name,
                      100.0 * light.back_share));
    }
    if (light.front_share > 0.0) {
      warnings.push_back(fmt::format(
          "lighting.{} stands between the camera and {:.1f} % of the part: the picture shows the "
          "light itself there.",
          light.name,
          100.0 * light.front_share));
    }
  }
  return warnings;
}

std::vector<std::string> path_warnings(const PhysicalScene& scene) {
  std::vector<std::string> warnings = hiding_warnings(scene);
  for (const std::vector<std::string>& more :
       {tilt_warnings(scene.lights), far_field_warnings(scene.lights, points_of(scene.part))}) {
    warnings.insert(warnings.end(), more.begin(), more.end());
  }
  return warnings;
}

std::vector<std::string> SceneLamps::warnings() const {
  return view_ == nullptr ? std::vector<std::string>() : path_warnings(view_->physical());
}

std::vector<std::string> SceneLamps::group_names() const {
  return view_ == nullptr ? std::vector<std::string>() : view_->group_names();
}

}  // namespace glint
