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
  // Of blurred reflections, measured once in CPU time: 24 + 2.4 a ray for a bent strip in a fine
  // picture, 50 + 39 a ray in one a quarter as fine.
  static constexpr double kLobes = 25.0;   ///< where directions are summed
  static constexpr double kLobeRay = 8.0;  ///< of each ray around them
  static constexpr double kWaves = 0.02;   ///< of a pixel's harmonics in one position
  // Of direct sums, measured once in CPU time: 3.8, 6.9, 26 for 1, 4, 16 rays, mean of a ring, a
  // dome and a bar over a plate.
  static constexpr double kSums = 2.5;    ///< what does not grow with the rays
  static constexpr double kSumRay = 1.4;  ///< of each ray
  // Where the part may stand in its own light every place of a lamp is asked for: 13, 119, 750 for
  // 1, 4, 16 rays of a gear under a ring, 290 for 4 rays as the mean of 30 rings.
  static constexpr double kShadedSum = 25.0;  ///< of one ray; grows as rays^1.5
};

constexpr double kUsual_rad = 2e-4;
constexpr double kMillion = 1e6;
constexpr const char* kMirrorLevel = "level 0";
constexpr const char* kBlurredLevel = "blurred";
constexpr const char* kDirectLevel = "direct sum";
constexpr int kFootprintGroup = 0;  ///< of what is not path tracing, whose groups are reflections

double pixels_of(const SceneSettings& scene) {
  return static_cast<double>(scene.camera.width_px) * scene.camera.height_px;
}

int frames_of(const SceneSettings& scene) {
  return scene.has_tunnel ? scene.scan.positions : 1;
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
  const int pictures = paths.batches > 1 ? paths.batches + 1 : 1;
  return paths.samples * path + WorkPerPixel::kScoring * frames_of(scene) * pictures;
}

double direct_work(const SceneSettings& scene) {
  const double rays = static_cast<double>(scene.render.rays_per_axis) * scene.render.rays_per_axis;
  const double sums = may_see_itself(scene) ? WorkPerPixel::kShadedSum * std::pow(rays, 1.5)
                                            : WorkPerPixel::kSums + WorkPerPixel::kSumRay * rays;
  return sums + WorkPerPixel::kScoring * frames_of(scene);
}

double blurred_work(const SceneSettings& scene) {
  const double rays = static_cast<double>(scene.render.rays_per_axis) * scene.render.rays_per_axis;
  return WorkPerPixel::kLobes + WorkPerPixel::kLobeRay * rays +
         WorkPerPixel::kWaves * scene.scan.positions;
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

std::string rays_name(int rays_per_axis) {
  const int rays = rays_per_axis * rays_per_axis;
  return fmt::format("{} ray{} a pixel", rays, rays == 1 ? "" : "s");
}

std::string mirror_name(const RenderSettings& render) {
  if (render.method == Method::kSampled) {
    return rays_name(render.rays_per_axis);
  }
  const char* how = render.method == Method::kIntegrated ? "frames" : "means";
  return fmt::format("{} of footprints to {:g} mrad", how, 1e3 * render.max_direction_error_rad);
}

std::string rung_level(const SceneSettings& scene) {
  if (is_blurred(scene) || is_direct(scene)) {
    return is_direct(scene) ? kDirectLevel : kBlurredLevel;
  }
  return needs_paths(scene) ? level_name(scene.paths.max_reflections) : kMirrorLevel;
}

std::string rung_name(const SceneSettings& scene) {
  if (is_blurred(scene) || is_direct(scene)) {
    return rung_level(scene) + ", " + rays_name(scene.render.rays_per_axis);
  }
  return needs_paths(scene) ? path_name(scene.paths) : mirror_name(scene.render);
}

/// Of several lamps one might hide another in some design, which sums do not model.
bool may_be_summed(const SceneSettings& scene) {
  return scene.lights.size() == 1 && direct_problems(scene).empty();
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
    if (scene_.render.method == Method::kSampled || is_blurred(scene_) || is_direct(scene_)) {
      add_sampled();
    } else if (needs_paths(scene_)) {
      add_noiseless();
      add_paths();
    } else {
      add_footprints();
    }
    std::ranges::stable_sort(rungs_, {}, &RenderRung::work);
    return std::move(rungs_);
  }

 private:
  void add(const SceneSettings& scene, int group, bool is_for_search = true) {
    const bool has_paths = needs_paths(scene) && !is_direct(scene);
    const Method method = scene.render.method;
    rungs_.push_back(
        {.name = rung_name(scene),
         .level = rung_level(scene),
         .render = scene.render,
         .paths = scene.paths,
         .work = counted_work(scene),
         .group = group,
         .has_derivatives = !has_paths && (method == Method::kAuto || method == Method::kClosed),
         .is_for_search = is_for_search,
         .is_noisy = has_paths});
  }

  /// Of rough metal that paths would follow, where the study does not ask for them by name.
  void add_noiseless() {
    if (kept_.method) {
      return;
    }
    if (blurred_problems(scene_).empty()) {
      add_noiseless(Method::kBlurred);
    }
    if (may_be_summed(scene_)) {
      add_noiseless(Method::kDirect);
    }
  }

  void add_noiseless(Method method) {
    SceneSettings scene = scene_;
    scene.render.method = method;
    const int own = scene_.render.rays_per_axis;
    for (const int rays : kept_.rays_per_axis ? std::vector{own} : std::vector{1, 2, 4}) {
      scene.render.rays_per_axis = rays;
      const bool is_modelled = method != Method::kDirect || may_be_summed(scene);
      if (is_modelled && counted_work(scene) < counted_work(top_)) {
        add(scene, kFootprintGroup);
      }
    }
  }

  static constexpr int kFewestSamples = 8;

  /// So that a step of at most half of the most is there: it tells how far the most are off.
  static int fewest_samples(int most) {
    int fewest = kFewestSamples;
    while (fewest > 1 && 2 * fewest > most) {
      fewest /= 2;
    }
    return fewest;
  }

  void add_paths() {
    const int most = kept_.samples ? scene_.paths.samples : top_.paths.samples;
    const int fewest = kept_.samples ? std::min(kFewestSamples, most) : fewest_samples(most);
    const std::vector<int> reflections = steps_to(1, scene_.paths.max_reflections);
    for (const int number : reflections) {
      SceneSettings scene = scene_;
      scene.paths.max_reflections = number;
      for (const int samples : steps_to(fewest, most)) {
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
      add(scene, kFootprintGroup);
    }
    if (kept_.rays_per_axis && top_.render.rays_per_axis > most) {
      add(top_, kFootprintGroup, false);
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
        add(scene, kFootprintGroup);
      }
    }
    add(top_, kFootprintGroup, !kept_.method && !kept_.max_direction_error);
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
  const std::vector<std::string> kept = names_of(kept_keys(study.root));
  const std::string why =
      kept.empty() ? "the scene has no other; remove [accuracy]"
                   : fmt::format(
                         "as these keys are set by hand: {}; remove them or [accuracy], or "
                         "free them by accuracy.keep = []",
                         fmt::join(kept, ", "));
  throw ConfigError(Problem{
      .kind = Problem::Kind::kRelation,
      .place = table.place,
      .key = "accuracy",
      .text = fmt::format("leaves one way to render, \"{}\", {}", ladder.front().name, why)});
}

SceneSettings at_rung(SceneSettings scene, const RenderRung& rung) {
  const bool is_blurred_rung = rung.render.method == Method::kBlurred;
  const bool is_direct_rung = rung.render.method == Method::kDirect;
  if ((is_blurred_rung && blurred_problems(scene).empty()) ||
      (is_direct_rung && (is_direct(scene) || may_be_summed(scene)))) {
    scene.render.method = rung.render.method;
    scene.render.rays_per_axis = rung.render.rays_per_axis;
  } else if (needs_paths(scene)) {
    scene.paths.samples = rung.paths.samples;
    scene.paths.max_reflections = rung.paths.max_reflections;
  } else if (!is_blurred_rung && !is_direct_rung) {
    scene.render.method = rung.render.method;
    scene.render.rays_per_axis = rung.render.rays_per_axis;
    scene.render.max_direction_error_rad = rung.render.max_direction_error_rad;
  }
  return scene;
}

bool is_rendered_alike(const SceneSettings& scene, std::span<const RenderRung> ladder) {
  const std::string first = rung_name(at_rung(scene, ladder.front()));
  return std::ranges::all_of(
      ladder, [&](const RenderRung& rung) { return rung_name(at_rung(scene, rung)) == first; });
}

double fineness_of(const RenderRung& rung) {
  if (rung.is_noisy) {
    return rung.paths.samples;
  }
  if (rung.render.method == Method::kSampled || rung.render.method == Method::kBlurred ||
      rung.render.method == Method::kDirect) {
    return static_cast<double>(rung.render.rays_per_axis) * rung.render.rays_per_axis;
  }
  return 1.0 / (rung.render.max_direction_error_rad * rung.render.max_direction_error_rad);
}

bool may_see_itself(const SceneSettings& scene) {
  const PartSettings::Shape shape = scene.part.shape;
  return shape == PartSettings::Shape::kSpurGear || shape == PartSettings::Shape::kMesh;
}

double counted_work(const SceneSettings& scene) {
  const double work = is_blurred(scene)    ? blurred_work(scene)
                      : is_direct(scene)   ? direct_work(scene)
                      : needs_paths(scene) ? path_work(scene)
                                           : mirror_work(scene);
  return pixels_of(scene) * work / kMillion;
}

double rescoring_factor(const SceneSettings& scene) {
  constexpr double kOfSamples = 4.0;
  return is_direct(scene) ? counted_work(finer_settings(scene)) / counted_work(scene) : kOfSamples;
}

}  // namespace glint
