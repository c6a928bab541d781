// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/render_methods.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

namespace glint {
namespace {

using Method = RenderSettings::Method;

/// The methods in the order of their kinds.
class MethodList {
 public:
  explicit MethodList(const RenderSettings& own)
      : own_(own), own_mrad_(own.max_direction_error_rad * 1e3) {
    for (const int per_axis : {1, 2, 4, 8, 16}) {
      add_sampled(per_axis);
    }
    for (const double mrad : {2.0, 0.2, 0.02}) {
      add(Method::kIntegrated,
          {.kind = 1,
           .kind_name = "integrated",
           .label = fmt::format("integrated, {:g} mrad", mrad),
           .direction_mrad = mrad,
           .is_usual = mrad == 0.2});
    }
    add(Method::kClosed,
        {.kind = 2,
         .kind_name = "closed forms",
         .label = "closed forms",
         .direction_mrad = own_mrad_,
         .has_frames = false});
    add_choice(false);
    add_choice(true);
  }

  std::vector<ComparedMethod> methods() { return std::move(methods_); }

 private:
  void add(Method method, ComparedMethod row) {
    row.render = own_;
    row.render.method = method;
    const bool is_own_accuracy = method == Method::kSampled
                                     ? row.rays_per_px == own_.rays_per_axis * own_.rays_per_axis
                                     : row.direction_mrad == own_mrad_;
    row.is_current =
        method == own_.method && is_own_accuracy && (method != Method::kAuto || row.has_frames);
    if (row.direction_mrad > 0.0) {
      row.render.max_direction_error_rad = row.direction_mrad * 1e-3;
    }
    methods_.push_back(std::move(row));
  }

  void add_choice(bool has_frames) {
    add(Method::kAuto,
        {.kind = 3,
         .kind_name = "own choice",
         .label = has_frames ? "own choice for pictures" : "own choice for scores",
         .direction_mrad = own_mrad_,
         .has_frames = has_frames,
         .is_choice = true});
  }

  void add_sampled(int rays_per_axis) {
    const int rays = rays_per_axis * rays_per_axis;
    add(Method::kSampled,
        {.kind = 0,
         .kind_name = "plain sampling",
         .label = fmt::format("{} ray{} a pixel", rays, rays == 1 ? "" : "s"),
         .rays_per_px = rays,
         .is_usual = rays == 4});
    methods_.back().render.rays_per_axis = rays_per_axis;
  }

  RenderSettings own_;
  double own_mrad_;
  std::vector<ComparedMethod> methods_;
};

std::string samples_text(int samples) {
  return fmt::format("{} sample{}", samples, samples == 1 ? "" : "s");
}

ComparedMethod path_method(const SceneSettings& scene, int samples, int reflections) {
  constexpr std::size_t kPathKind = 4;
  ComparedMethod method = {.kind = kPathKind,
                           .kind_name = "paths",
                           .label = samples_text(samples),
                           .render = scene.render,
                           .paths = scene.paths,
                           .follows_paths = true};
  method.render.method = Method::kPaths;
  method.paths.samples = samples;
  method.paths.max_reflections = reflections;
  method.is_current = samples == scene.paths.samples && reflections == scene.paths.max_reflections;
  method.is_usual = method.is_current;
  if (reflections != scene.paths.max_reflections) {
    method.label += fmt::format(", {} reflection{}", reflections, reflections == 1 ? "" : "s");
  }
  return method;
}

}  // namespace

void visit_keys(KeyVisitor& keys, RenderTable& table) {
  visit_keys(keys, table.render);
  keys.table(
      "paths",
      [&](KeyVisitor& inner) { visit_keys(inner, table.paths); },
      "of pictures by path tracing");
}

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
    constexpr int kMaxSamples = 65535;
    scene.paths.seed += kFreshSeed;
    scene.paths.samples = std::min(kMaxSamples, kMoreSamples * scene.paths.samples);
  } else if (scene.render.method == Method::kSampled) {
    scene.render.rays_per_axis *= 2;
  } else {
    scene.render.method = Method::kIntegrated;
    scene.render.max_direction_error_rad *= 0.25;
  }
  return scene;
}

SceneSettings coarse_settings(SceneSettings scene) {
  if (!needs_paths(scene)) {
    scene.render.method = Method::kSampled;
    scene.render.rays_per_axis = 1;
  }
  return scene;
}

SceneSettings repeated_settings(SceneSettings scene, int index) {
  constexpr int kFirstSeed = 2000003;
  constexpr int kStride = 1000;  // more than the scans behind one interval
  const int seed = kFirstSeed + kStride * index;
  scene.sensor.seed += seed;
  scene.paths.seed += needs_paths(scene) ? seed : 0;
  return scene;
}

std::vector<ComparedMethod> compared_methods(const SceneSettings& scene) {
  return needs_paths(scene) ? std::vector<ComparedMethod>() : MethodList(scene.render).methods();
}

std::vector<ComparedMethod> compared_paths(const SceneSettings& scene) {
  std::vector<ComparedMethod> methods;
  if (!needs_paths(scene)) {
    return methods;
  }
  const PathSettings& own = scene.paths;
  std::set<int> samples = {1, 4, 16, 64, 256, 1024};
  samples.insert(own.samples);
  for (const int count : samples) {
    methods.push_back(path_method(scene, count, own.max_reflections));
  }
  std::set<int> reflections = {2 * own.max_reflections};
  for (const int count : {1, 2, 4}) {
    if (count < own.max_reflections) {
      reflections.insert(count);
    }
  }
  for (const int count : reflections) {
    methods.push_back(path_method(scene, own.samples, count));
  }
  return methods;
}

SceneSettings rendered_by(const ComparedMethod& method, SceneSettings scene) {
  scene.render = method.render;
  if (method.follows_paths) {
    scene.paths = method.paths;
  }
  return scene;
}

SceneSettings independent_paths(SceneSettings scene, int samples, int index) {
  constexpr int kFirstSeed = 4000037;
  constexpr int kStride = 7919;
  scene.paths.samples = samples;
  scene.paths.seed += kFirstSeed + kStride * index;
  return scene;
}

}  // namespace glint
