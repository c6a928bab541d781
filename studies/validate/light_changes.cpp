// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/light_changes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <variant>

#include "studies/imaging/path_lights.h"

namespace glint {
namespace {

void change_light(LightSettings& settings, const LightChange& change) {
  std::visit(
      [&](auto& light) {
        for (std::size_t i = 0; i < 3; ++i) {
          light.placement.position_mm[i] += change.moved_mm[static_cast<Eigen::Index>(i)];
        }
      },
      settings);
  LightSegments* segments = segments_of(settings);
  if (segments != nullptr &&
      change.segment_power.size() == static_cast<std::size_t>(segments->segments)) {
    std::vector<double>& powers = segments->segment_power;
    powers.resize(change.segment_power.size(), 1.0);
    std::ranges::transform(powers, change.segment_power, powers.begin(), std::multiplies{});
  }
}

}  // namespace

std::vector<LitLight> lights_with_bodies(const SceneSettings& scene) {
  std::vector<LitLight> found;
  for (NamedLight light : scene.lights) {
    if (has_place(light.settings) && (shines(light.settings) || has_body(light.settings))) {
      const LightSegments* segments = segments_of(light.settings);
      found.push_back({.name = light.name,
                       .segments = segments != nullptr ? segments->segments : 1,
                       .can_move = true});
    }
  }
  return found;
}

SceneSettings with_separate_segments(SceneSettings scene) {
  for (NamedLight& light : scene.lights) {
    if (LightSegments* segments = segments_of(light.settings); segments != nullptr) {
      segments->separate = segments->segments > 1;
    }
  }
  return scene;
}

SceneSettings changed_scene(SceneSettings scene, const SceneChange& change) {
  scene.sensor.exposure *= change.exposure;
  scene.sensor.blur_px =
      std::sqrt(std::max(0.0, scene.sensor.blur_px * scene.sensor.blur_px + change.blur_px2));
  if (change.roughness != 1.0) {
    scene.material.roughness = std::clamp(scene.material.roughness * change.roughness, 0.0, 1.0);
  }
  for (const LightChange& light : change.lights) {
    const auto found = std::ranges::find(scene.lights, light.name, &NamedLight::name);
    if (found != scene.lights.end()) {
      change_light(found->settings, light);
    }
  }
  return scene;
}

}  // namespace glint
