// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/light_changes.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

namespace glint {
namespace {

template <class Light>
constexpr bool kHasSegments = requires(Light light) {
  light.segments.segments;
};

template <class Light>
constexpr bool kHasEmission = requires(Light light) {
  light.emission;
};

template <class Light>
constexpr bool kCanMove = !std::is_same_v<Light, EnvironmentSettings>;

template <class Light>
constexpr bool kHasBody = kHasEmission<Light>;

bool shines(const std::vector<double>& values) {
  return std::ranges::any_of(values, [](double value) { return value > 0.0; });
}

template <class Light>
bool is_on(const Light& light) {
  if constexpr (kHasEmission<Light>) {
    return light.emission.power_w.empty() ? shines(light.emission.radiance)
                                          : shines(light.emission.power_w);
  } else if constexpr (std::is_same_v<Light, IesLightSettings>) {
    return shines(light.scale);
  } else {
    return shines(light.radiance);
  }
}

template <class Wanted>
std::vector<LitLight> lights_that(const SceneSettings& scene, const Wanted& is_wanted) {
  std::vector<LitLight> found;
  for (const NamedLight& light : scene.lights) {
    std::visit(
        [&](const auto& settings) {
          using Light = std::decay_t<decltype(settings)>;
          LitLight row = {.name = light.name, .can_move = kCanMove<Light>};
          if constexpr (kHasSegments<Light>) {
            row.segments = settings.segments.segments;
          }
          if (kCanMove<Light> && is_wanted(settings)) {
            found.push_back(row);
          }
        },
        light.settings);
  }
  return found;
}

void change_light(LightSettings& settings, const LightChange& change) {
  std::visit(
      [&](auto& light) {
        using Light = std::decay_t<decltype(light)>;
        for (std::size_t i = 0; i < 3; ++i) {
          light.placement.position_mm[i] += change.moved_mm[static_cast<Eigen::Index>(i)];
        }
        if constexpr (kHasSegments<Light>) {
          std::vector<double>& powers = light.segments.segment_power;
          if (change.segment_power.size() == static_cast<std::size_t>(light.segments.segments)) {
            powers.resize(change.segment_power.size(), 1.0);
            std::ranges::transform(powers, change.segment_power, powers.begin(), std::multiplies{});
          }
        }
      },
      settings);
}

}  // namespace

std::vector<LitLight> lights_with_bodies(const SceneSettings& scene) {
  return lights_that(scene, [](const auto& settings) {
    return is_on(settings) || kHasBody<std::decay_t<decltype(settings)>>;
  });
}

SceneSettings with_separate_segments(SceneSettings scene) {
  for (NamedLight& light : scene.lights) {
    std::visit(
        [](auto& settings) {
          if constexpr (kHasSegments<std::decay_t<decltype(settings)>>) {
            settings.segments.separate = settings.segments.segments > 1;
          }
        },
        light.settings);
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
