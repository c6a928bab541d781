// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/render_methods.h"

#include <algorithm>
#include <cmath>
#include <iterator>
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

constexpr double kLeastAlpha = 0.02;
constexpr double kLargestAlpha = 0.1;

/// What of a scene blurred reflections do not model.
class BlurredRange {
 public:
  explicit BlurredRange(const SceneSettings& scene) : scene_(scene) {}

  std::vector<Problem> problems() {
    check_light();
    check_material();
    check_width();
    check_camera();
    for (const auto& [name, group] : scene_.defects) {
      expect(group.type != DefectType::kStain,
             fmt::format("defects.{}.type", name),
             "is \"stain\"",
             "are all other types");
    }
    return std::move(problems_);
  }

 private:
  void expect(bool is_right,
              const std::string& key,
              const std::string& what,
              const std::string& allowed) {
    if (!is_right) {
      problems_.push_back(
          {.kind = Problem::Kind::kRelation,
           .key = key,
           .text = fmt::format("{}, which render.method = \"blurred\" does not model; allowed {}, "
                               "or render.method = \"paths\"",
                               what,
                               allowed)});
    }
  }

  void check_light() {
    expect(scene_.has_tunnel, "render.method", "finds no tunnel", "is one tunnel that shines");
    for (const NamedLight& light : scene_.lights) {
      expect(false, "lighting." + light.name, "shines too", "is one tunnel alone");
    }
    const std::string table = "lighting." + scene_.tunnel_name;
    const TunnelSettings& tunnel = scene_.tunnel;
    const auto expect_none = [&](const char* name, double value) {
      expect(!scene_.has_tunnel || value == 0.0,
             fmt::format("{}.{}", table, name),
             fmt::format("is {:g}", value),
             "is 0");
    };
    expect_none("led_ripple", tunnel.led_ripple);
    expect_none("end_falloff", tunnel.end_falloff);
  }

  void check_material() {
    const MaterialSettings& material = scene_.material;
    expect(material.type == MaterialSettings::Type::kConductor,
           "material.type",
           material.type == MaterialSettings::Type::kMirror ? "is \"mirror\"" : "is \"diffuse\"",
           "is \"conductor\"");
    expect(material.coat.index == 1.0,
           "material.coat.index",
           fmt::format("is {:g}", material.coat.index),
           "is 1, no coat");
    expect(material.pattern.kind == PatternSettings::Kind::kNone,
           "material.pattern.kind",
           "marks the surface",
           "is \"none\"");
    expect(material.texture.is_empty(), "material.texture", "names pictures", "are none");
  }

  void check_width() {
    const MaterialSettings& material = scene_.material;
    if (material.type != MaterialSettings::Type::kConductor) {
      return;
    }
    const bool has_alpha = !material.alpha.empty();
    const double alpha =
        has_alpha ? material.alpha.front() : material.roughness * material.roughness;
    const bool is_even = has_alpha ? material.alpha.back() == alpha : material.anisotropy == 0.0;
    if (!is_even) {
      expect(false,
             has_alpha ? "material.alpha" : "material.anisotropy",
             "makes widths along and across differ",
             has_alpha ? "are equal ones" : "is 0");
      return;
    }
    expect(alpha >= kLeastAlpha && alpha <= kLargestAlpha,
           has_alpha ? "material.alpha" : "material.roughness",
           has_alpha ? fmt::format("is {:g}", alpha)
                     : fmt::format("is {:g}, a width of {:g}", material.roughness, alpha),
           has_alpha
               ? fmt::format("are {:g} to {:g}", kLeastAlpha, kLargestAlpha)
               : fmt::format(
                     "are {:.3f} to {:.3f}", std::sqrt(kLeastAlpha), std::sqrt(kLargestAlpha)));
  }

  void check_camera() {
    expect(scene_.sensor.wavelengths_nm.size() == 1,
           "sensor.wavelengths_nm",
           "has 3 numbers",
           "is 1, a grey camera");
    expect(scene_.lens.f_number == 0.0,
           "lens.f_number",
           fmt::format("is {:g}", scene_.lens.f_number),
           "is 0, a pinhole");
  }

  const SceneSettings& scene_;
  std::vector<Problem> problems_;
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
  method.is_usual = samples == scene.paths.samples && reflections == scene.paths.max_reflections;
  method.is_current = method.is_usual && !is_blurred(scene);
  if (reflections != scene.paths.max_reflections) {
    method.label += fmt::format(", {} reflection{}", reflections, reflections == 1 ? "" : "s");
  }
  return method;
}

ComparedMethod blurred_method(const SceneSettings& scene, int rays_per_axis) {
  constexpr std::size_t kBlurredKind = 5;
  const int rays = rays_per_axis * rays_per_axis;
  ComparedMethod method = {.kind = kBlurredKind,
                           .kind_name = "blurred",
                           .label = fmt::format("blurred, {} ray{}", rays, rays == 1 ? "" : "s"),
                           .render = scene.render,
                           .paths = scene.paths,
                           .rays_per_px = rays};
  method.render.method = Method::kBlurred;
  method.render.rays_per_axis = rays_per_axis;
  method.is_current = is_blurred(scene) && rays_per_axis == scene.render.rays_per_axis;
  return method;
}

/// Those of the same scene; none where it is out of their range.
std::vector<ComparedMethod> blurred_methods(const SceneSettings& scene) {
  std::vector<ComparedMethod> methods;
  if (blurred_problems(scene).empty()) {
    std::set<int> rays_per_axis = {1, 2, 4};
    if (is_blurred(scene)) {
      rays_per_axis.insert(scene.render.rays_per_axis);
    }
    for (const int rays : rays_per_axis) {
      methods.push_back(blurred_method(scene, rays));
    }
  }
  return methods;
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
  if (is_blurred(scene)) {
    return {.name = "blurred", .numbers = {{"rays_per_axis", scene.render.rays_per_axis}}};
  }
  return {.name = method == Method::kSampled ? "sampled" : "integrated",
          .has_closed_mean = method == Method::kAuto || method == Method::kClosed};
}

bool is_blurred(const SceneSettings& scene) {
  return scene.render.method == Method::kBlurred;
}

std::vector<Problem> blurred_problems(const SceneSettings& scene) {
  return BlurredRange(scene).problems();
}

SceneSettings finer_settings(SceneSettings scene) {
  constexpr int kFreshSeed = 1000003;
  scene.sensor.seed += kFreshSeed;
  if (needs_paths(scene)) {
    constexpr int kMoreSamples = 4;  // half the standard error
    constexpr int kMaxSamples = 65535;
    scene.paths.seed += kFreshSeed;
    scene.paths.samples = std::min(kMaxSamples, kMoreSamples * scene.paths.samples);
  } else if (scene.render.method == Method::kSampled || is_blurred(scene)) {
    scene.render.rays_per_axis *= 2;
  } else {
    scene.render.method = Method::kIntegrated;
    scene.render.max_direction_error_rad *= 0.25;
  }
  return scene;
}

SceneSettings coarse_settings(SceneSettings scene) {
  if (!needs_paths(scene)) {
    scene.render.method = is_blurred(scene) ? Method::kBlurred : Method::kSampled;
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
  return needs_paths(scene) || is_blurred(scene) ? std::vector<ComparedMethod>()
                                                 : MethodList(scene.render).methods();
}

std::vector<ComparedMethod> compared_paths(const SceneSettings& scene) {
  std::vector<ComparedMethod> methods;
  if (!needs_paths(scene) && !is_blurred(scene)) {
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
  std::ranges::move(blurred_methods(scene), std::back_inserter(methods));
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
  if (is_blurred(scene)) {
    scene.render.method = Method::kPaths;
  }
  scene.paths.samples = samples;
  scene.paths.seed += kFirstSeed + kStride * index;
  return scene;
}

}  // namespace glint
