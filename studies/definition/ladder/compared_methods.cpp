// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/compared_methods.h"

#include <algorithm>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "studies/definition/render_methods.h"

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
                           .is_noisy = true,
                           .has_film = true};
  method.render.method = Method::kPaths;
  method.paths.samples = samples;
  method.paths.max_reflections = reflections;
  method.is_usual = samples == scene.paths.samples && reflections == scene.paths.max_reflections;
  method.is_current = method.is_usual && !is_blurred(scene) && !is_direct(scene);
  if (reflections != scene.paths.max_reflections) {
    method.label += fmt::format(", {} reflection{}", reflections, reflections == 1 ? "" : "s");
  }
  return method;
}

/// Of those that have no noise and whose accuracy is a number of rays.
ComparedMethod noiseless_method(const SceneSettings& scene, Method method, int rays_per_axis) {
  const bool is_sum = method == Method::kDirect;
  const int rays = rays_per_axis * rays_per_axis;
  const char* name = is_sum ? "direct sum" : "blurred";
  ComparedMethod row = {.kind = is_sum ? 6U : 5U,
                        .kind_name = name,
                        .label = fmt::format("{}, {} ray{}", name, rays, rays == 1 ? "" : "s"),
                        .render = scene.render,
                        .paths = scene.paths,
                        .rays_per_px = rays,
                        .has_film = is_sum};
  row.render.method = method;
  row.render.rays_per_axis = rays_per_axis;
  row.is_current = scene.render.method == method && rays_per_axis == scene.render.rays_per_axis;
  return row;
}

/// Those that may render the same scene.
std::vector<ComparedMethod> noiseless_methods(const SceneSettings& scene) {
  std::vector<ComparedMethod> methods;
  for (const Method method : {Method::kBlurred, Method::kDirect}) {
    const bool is_blur = method == Method::kBlurred;
    if (!(is_blur ? blurred_problems(scene) : direct_problems(scene)).empty()) {
      continue;
    }
    std::set<int> rays_per_axis = {1, 2, 4};
    if (scene.render.method == method) {
      rays_per_axis.insert(scene.render.rays_per_axis);
    }
    for (const int rays : rays_per_axis) {
      methods.push_back(noiseless_method(scene, method, rays));
    }
  }
  return methods;
}

}  // namespace

bool has_noiseless_reference(const SceneSettings& scene) {
  return !needs_paths(scene) && !is_blurred(scene);
}

std::vector<ComparedMethod> compared_methods(const SceneSettings& scene) {
  return has_noiseless_reference(scene) ? MethodList(scene.render).methods()
                                        : std::vector<ComparedMethod>();
}

std::vector<ComparedMethod> compared_paths(const SceneSettings& scene) {
  std::vector<ComparedMethod> methods;
  if (has_noiseless_reference(scene)) {
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
  std::ranges::move(noiseless_methods(scene), std::back_inserter(methods));
  return methods;
}

SceneSettings rendered_by(const ComparedMethod& method, SceneSettings scene) {
  scene.render = method.render;
  if (method.is_noisy) {
    scene.paths = method.paths;
  }
  return scene;
}

SceneSettings independent_paths(SceneSettings scene, int samples, int index) {
  constexpr int kFirstSeed = 4000037;
  constexpr int kStride = 7919;
  if (is_blurred(scene) || is_direct(scene)) {
    scene.render.method = Method::kPaths;
  }
  scene.paths.samples = samples;
  scene.paths.seed += kFirstSeed + kStride * index;
  return scene;
}

}  // namespace glint
