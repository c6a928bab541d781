// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/render_ladder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "studies/definition/render_methods.h"

namespace glint {
namespace {

using Method = RenderSettings::Method;

/// Work in camera paths with direct light: estimates, not measured. Ratios matter, not the unit:
/// what is compared are rungs of one scene.
struct WorkPerPixel {
  static constexpr double kReflection = 0.5;  ///< of a path, each one after the first
  static constexpr double kReturn = 0.5;      ///< share of paths that meet the part once more
  static constexpr double kScoring = 0.5;     ///< of a frame, and of each batch once more
  static constexpr double kClosed = 0.05;     ///< a footprint and its mean
  static constexpr double kFrame = 0.01;      ///< a footprint in one position
  static constexpr double kRay = 0.02;        ///< a sampled ray and its light
  static constexpr double kRayFrame = 0.003;  ///< the same ray in one more position
  static constexpr double kTraced = 0.1;      ///< a ray that is kept, at 0.2 mrad
};

constexpr double kUsual_rad = 2e-4;
constexpr double kMillion = 1e6;
constexpr const char* kMirrorLevel = "level 0";

double pixels_of(const SceneSettings& scene) {
  return static_cast<double>(scene.camera.width_px) * scene.camera.height_px;
}

double path_work(const SceneSettings& scene) {
  const PathSettings& paths = scene.paths;
  // Of all paths kReturn go on after each reflection: a geometric series.
  double path = 1.0;
  double share = WorkPerPixel::kReturn;
  for (int k = 1; k < paths.max_reflections; ++k) {
    path += WorkPerPixel::kReflection * share;
    share *= WorkPerPixel::kReturn;
  }
  const int frames = scene.has_tunnel ? scene.scan.positions : 1;
  const int pictures = paths.batches > 1 ? paths.batches + 1 : 1;
  return paths.samples * path + WorkPerPixel::kScoring * frames * pictures;
}

double mirror_work(const SceneSettings& scene) {
  const RenderSettings& render = scene.render;
  const int positions = scene.scan.positions;
  if (render.method == Method::kSampled) {
    const double rays = static_cast<double>(render.rays_per_axis) * render.rays_per_axis;
    return rays * (WorkPerPixel::kRay + WorkPerPixel::kRayFrame * positions) +
           WorkPerPixel::kTraced * rays;
  }
  // Rays are refined where neighbours part by more than the error: along two axes, each as often as
  // the root of what is allowed.
  const double traced = WorkPerPixel::kTraced * kUsual_rad / render.max_direction_error_rad;
  const bool has_frames = render.method == Method::kIntegrated;
  return WorkPerPixel::kClosed + traced + (has_frames ? WorkPerPixel::kFrame * positions : 0.0);
}

/// Values of an upper limit: the steps below it and the limit itself.
std::vector<int> steps_to(int first, int limit) {
  std::vector<int> steps;
  for (int step = first; step < limit; step *= 2) {
    steps.push_back(step);
  }
  steps.push_back(limit);
  return steps;
}

std::string level_name(int reflections) {
  return reflections == 1 ? "direct light" : fmt::format("{} reflections", reflections);
}

std::string path_name(const PathSettings& paths) {
  return fmt::format("{}, {} samples", level_name(paths.max_reflections), paths.samples);
}

std::string mirror_name(const RenderSettings& render) {
  if (render.method == Method::kSampled) {
    const int rays = render.rays_per_axis * render.rays_per_axis;
    return fmt::format("{} ray{} a pixel", rays, rays == 1 ? "" : "s");
  }
  const char* how = render.method == Method::kIntegrated ? "frames" : "means";
  return fmt::format("{} of footprints to {:g} mrad", how, 1e3 * render.max_direction_error_rad);
}

/// What finalists are re-scored with, but for their seeds.
SceneSettings top_settings(const SceneSettings& scene) {
  SceneSettings top = finer_settings(scene);
  top.sensor.seed = scene.sensor.seed;
  top.paths.seed = scene.paths.seed;
  return top;
}

/// Puts together the rungs of one scene.
class RungList {
 public:
  RungList(const SceneSettings& scene, const KeptKeys& kept)
      : scene_(scene), kept_(kept), top_(top_settings(scene)) {}

  std::vector<RenderRung> rungs() {
    if (needs_paths(scene_)) {
      add_paths();
    } else if (scene_.render.method == Method::kSampled) {
      add_sampled();
    } else {
      add_footprints();
    }
    std::ranges::stable_sort(rungs_, {}, &RenderRung::work);
    return std::move(rungs_);
  }

 private:
  void add(const SceneSettings& scene, int group, bool is_for_search = true) {
    const bool has_paths = needs_paths(scene);
    const Method method = scene.render.method;
    rungs_.push_back(
        {.name = has_paths ? path_name(scene.paths) : mirror_name(scene.render),
         .level = has_paths ? level_name(scene.paths.max_reflections) : kMirrorLevel,
         .render = scene.render,
         .paths = scene.paths,
         .work = counted_work(scene),
         .group = group,
         .has_derivatives = !has_paths && (method == Method::kAuto || method == Method::kClosed),
         .is_for_search = is_for_search});
  }

  void add_paths() {
    constexpr int kFewestSamples = 8;
    const int most = kept_.samples ? scene_.paths.samples : top_.paths.samples;
    const std::vector<int> reflections = steps_to(1, scene_.paths.max_reflections);
    for (const int number : reflections) {
      SceneSettings scene = scene_;
      scene.paths.max_reflections = number;
      for (const int samples : steps_to(std::min(kFewestSamples, most), most)) {
        scene.paths.samples = samples;
        add(scene, number);
      }
    }
    if (kept_.samples) {
      add(top_, scene_.paths.max_reflections, false);
    }
  }

  void add_sampled() {
    const int most = kept_.rays_per_axis ? scene_.render.rays_per_axis : top_.render.rays_per_axis;
    const int first = kept_.rays_per_axis ? most : 1;
    SceneSettings scene = scene_;
    for (const int rays : steps_to(first, most)) {
      scene.render.rays_per_axis = rays;
      add(scene, 0);
    }
    if (kept_.rays_per_axis) {
      add(top_, 0, false);
    }
  }

  void add_footprints() {
    constexpr std::array kErrors_rad = {2e-3, 6e-4, 2e-4, 6e-5};
    SceneSettings scene = scene_;
    for (const double error_rad : kErrors_rad) {
      if (!kept_.max_direction_error) {
        scene.render.max_direction_error_rad = error_rad;
      }
      if (counted_work(scene) < counted_work(top_) &&
          (rungs_.empty() || !kept_.max_direction_error)) {
        add(scene, 0);
      }
    }
    add(top_, 0, !kept_.method && !kept_.max_direction_error);
  }

  const SceneSettings& scene_;
  const KeptKeys& kept_;
  SceneSettings top_;
  std::vector<RenderRung> rungs_;
};

}  // namespace

std::vector<RenderRung> render_ladder(const SceneSettings& scene, const KeptKeys& kept) {
  return RungList(scene, kept).rungs();
}

std::vector<RenderRung> render_ladder(std::span<const SceneSettings> designs,
                                      const KeptKeys& kept) {
  const auto found = std::ranges::find_if(designs, needs_paths);
  return render_ladder(found != designs.end() ? *found : designs.front(), kept);
}

void check_ladder(const Study& study, const std::vector<RenderRung>& ladder) {
  if (std::ranges::count_if(ladder, &RenderRung::is_for_search) > 1) {
    return;
  }
  const ConfigNode& table = *study.root.find("accuracy");
  throw ConfigError(Problem{
      .kind = Problem::Kind::kRelation,
      .place = table.place,
      .key = "accuracy",
      .text = fmt::format("leaves one way to render, \"{}\", as these keys are set by hand: {}; "
                          "remove them or [accuracy], or free them by accuracy.keep = []",
                          ladder.front().name,
                          fmt::join(names_of(kept_keys(study.root)), ", "))});
}

SceneSettings at_rung(SceneSettings scene, const RenderRung& rung) {
  if (needs_paths(scene)) {
    scene.paths.samples = rung.paths.samples;
    scene.paths.max_reflections = rung.paths.max_reflections;
  } else {
    scene.render.method = rung.render.method;
    scene.render.rays_per_axis = rung.render.rays_per_axis;
    scene.render.max_direction_error_rad = rung.render.max_direction_error_rad;
  }
  return scene;
}

double fineness_of(const RenderRung& rung) {
  if (rung.level != kMirrorLevel) {
    return rung.paths.samples;
  }
  if (rung.render.method == Method::kSampled) {
    return static_cast<double>(rung.render.rays_per_axis) * rung.render.rays_per_axis;
  }
  return 1.0 / (rung.render.max_direction_error_rad * rung.render.max_direction_error_rad);
}

double counted_work(const SceneSettings& scene) {
  return pixels_of(scene) * (needs_paths(scene) ? path_work(scene) : mirror_work(scene)) / kMillion;
}

}  // namespace glint
