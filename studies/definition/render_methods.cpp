// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/render_methods.h"

#include <algorithm>

namespace glint {
namespace {

using Method = RenderSettings::Method;

}  // namespace

FrameMethod frame_method(const SceneSettings& scene) {
  const PathSettings& paths = scene.paths;
  if (needs_paths(scene)) {
    return {.name = "paths",
            .numbers = {{"samples", paths.samples},
                        {"batches", paths.batches},
                        {"max_reflections", paths.max_reflections}}};
  }
  const Method method = scene.render.method;
  return {.name = method == Method::kSampled ? "sampled" : "integrated",
          .has_closed_mean = method == Method::kAuto || method == Method::kClosed};
}

SceneSettings finer_settings(SceneSettings scene) {
  constexpr int kFreshSeed = 1000003;
  scene.sensor.seed += kFreshSeed;
  if (needs_paths(scene)) {
    constexpr int kMoreSamples = 4;  // half the standard error
    constexpr int kMostSamples = 65535;
    scene.paths.seed += kFreshSeed;
    scene.paths.samples = std::min(kMostSamples, kMoreSamples * scene.paths.samples);
  } else if (scene.render.method == Method::kSampled) {
    scene.render.rays_per_axis *= 2;
  } else {
    scene.render.method = Method::kIntegrated;
    scene.render.max_direction_error_rad *= 0.25;
  }
  return scene;
}

}  // namespace glint
