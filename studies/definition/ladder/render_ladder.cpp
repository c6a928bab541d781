// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/render_ladder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "studies/definition/ladder/larger_pixels.h"
#include "studies/definition/render_methods.h"

namespace glint {
namespace {

using Method = RenderSettings::Method;

constexpr const char* kMirrorLevel = "level 0";
constexpr const char* kBlurredLevel = "blurred";
constexpr const char* kDirectLevel = "direct sum";
constexpr const char* kHalfLevel = "half resolution";
constexpr int kFootprintGroup = 0;  ///< of what is not path tracing, whose groups are reflections
constexpr int kHalfGroup = -1;
constexpr int kHalf = 2;
constexpr int kMinSide_px = 64;  ///< of a picture that half resolution leaves something of

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
  SceneSettings top = rescoring_settings(scene);
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
      add_half_resolution();
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
         .is_noisy = has_paths,
         .is_summed = is_blurred(scene) || is_direct(scene)});
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

  static constexpr int kMinSamples = 8;

  /// So that a step of at most half of the most is there: it tells how far the most are off.
  static int min_samples(int most) {
    int samples = kMinSamples;
    while (samples > 1 && 2 * samples > most) {
      samples /= 2;
    }
    return samples;
  }

  void add_paths() {
    const int most = kept_.samples ? scene_.paths.samples : top_.paths.samples;
    const int least = kept_.samples ? std::min(kMinSamples, most) : min_samples(most);
    const int all = scene_.paths.max_reflections;
    const std::vector<int> reflections = steps_to(kept_.reflections ? all : 1, all);
    for (const int number : reflections) {
      SceneSettings scene = scene_;
      scene.paths.max_reflections = number;
      for (const int samples : steps_to(least, most)) {
        scene.paths.samples = samples;
        add(scene, number);
      }
    }
    if (kept_.samples) {
      add(top_, scene_.paths.max_reflections, false);
    }
  }

  /// A quarter of the pixels, each with as many samples: every second step, as errors soon end at
  /// what larger pixels cannot show.
  void add_half_resolution() {
    const CameraSettings& camera = scene_.camera;
    if (kept_.resolution || scene_.reference ||
        std::min(camera.width_px, camera.height_px) < kMinSide_px) {
      return;
    }
    const int most = kept_.samples ? scene_.paths.samples : top_.paths.samples;
    SceneSettings half = with_larger_pixels(scene_, kHalf);
    for (int samples = kMinSamples; samples <= most; samples *= 4) {
      half.paths.samples = samples;
      add(half, kHalfGroup);
      RenderRung& rung = rungs_.back();
      rung.name = fmt::format("{}, {}", kHalfLevel, rung.name);
      rung.level = kHalfLevel;
      rung.pixel_factor = kHalf;
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
    scene = with_larger_pixels(std::move(scene), rung.pixel_factor);
  } else if (!is_blurred_rung && !is_direct_rung) {
    scene.render.method = rung.render.method;
    scene.render.rays_per_axis = rung.render.rays_per_axis;
    scene.render.max_direction_error_rad = rung.render.max_direction_error_rad;
  }
  return scene;
}

void less_offsets(const SceneSettings& scene,
                  const RenderRung& rung,
                  std::map<std::string, double>& scores) {
  if (!needs_paths(scene)) {
    return;
  }
  for (const auto& [name, offset] : rung.offsets) {
    if (const auto found = scores.find(name); found != scores.end()) {
      found->second -= offset;
    }
  }
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

}  // namespace glint
