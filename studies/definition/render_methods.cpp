// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/render_methods.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "simulator/material/ggx.h"

namespace glint {
namespace {

using RenderMethod = RenderSettings::Method;

/// What of a scene a method does not model, problem by problem.
class MethodRange {
 protected:
  MethodRange(const SceneSettings& scene, RenderMethod method) : scene_(scene), method_(method) {}

  void expect(bool is_right,
              const std::string& key,
              const std::string& what,
              const std::string& allowed) {
    if (!is_right) {
      problems_.push_back(
          {.kind = Problem::Kind::kRelation,
           .key = key,
           .text = fmt::format("{}, which render.method = \"{}\" does not model; allowed {}, "
                               "or render.method = \"paths\"",
                               what,
                               method_name(method_),
                               allowed)});
    }
  }

  void expect_bare_metal() {
    const MaterialSettings& material = scene_.material;
    expect(material.type == MaterialSettings::Type::kConductor,
           "material.type",
           material.type == MaterialSettings::Type::kMirror ? "is \"mirror\"" : "is \"diffuse\"",
           "is \"conductor\"");
    expect(material.coat.index == 1.0,
           "material.coat.index",
           fmt::format("is {:g}", material.coat.index),
           "is 1, no coat");
  }

  void expect_pinhole() {
    expect(scene_.lens.f_number == 0.0,
           "lens.f_number",
           fmt::format("is {:g}", scene_.lens.f_number),
           "is 0, a pinhole");
  }

  const SceneSettings& scene_;
  RenderMethod method_;
  std::vector<Problem> problems_;
};

constexpr double kMinAlpha = 0.02;
constexpr double kLargestAlpha = 0.1;

/// What of a scene blurred reflections do not model.
class BlurredRange : public MethodRange {
 public:
  explicit BlurredRange(const SceneSettings& scene) : MethodRange(scene, RenderMethod::kBlurred) {}

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
  void check_light() {
    expect(scene_.has_tunnel,
           "render.method",
           "is used where no tunnel is switched on",
           "is exactly one tunnel that is switched on");
    for (const NamedLight& light : scene_.lights) {
      expect(false,
             "lighting." + light.name,
             "is switched on, too",
             "is one tunnel and no other light");
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
    expect_bare_metal();
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
    expect(alpha >= kMinAlpha && alpha <= kLargestAlpha,
           has_alpha ? "material.alpha" : "material.roughness",
           has_alpha ? fmt::format("is {:g}", alpha)
                     : fmt::format("is {:g}, a width of {:g}", material.roughness, alpha),
           has_alpha ? fmt::format("are {:g} to {:g}", kMinAlpha, kLargestAlpha)
                     : fmt::format(
                           "are {:.3f} to {:.3f}", std::sqrt(kMinAlpha), std::sqrt(kLargestAlpha)));
  }

  void check_camera() {
    expect(scene_.sensor.wavelengths_nm.size() == 1,
           "sensor.wavelengths_nm",
           "has 3 numbers",
           "is 1, a grey camera");
    expect_pinhole();
  }
};

constexpr double kMinDirectAlpha = 0.05;
constexpr int kMaxDirectRays = 4;  ///< along each side of a pixel

/// What of a scene the sum of direct light does not model.
class DirectRange : public MethodRange {
 public:
  explicit DirectRange(const SceneSettings& scene) : MethodRange(scene, RenderMethod::kDirect) {}

  std::vector<Problem> problems() {
    check_lights();
    check_surface();
    expect_pinhole();
    const int rays = scene_.render.rays_per_axis;
    expect(!is_direct(scene_) || rays <= kMaxDirectRays,
           "render.rays_per_axis",
           fmt::format("is {}", rays),
           fmt::format("are 1 to {}", kMaxDirectRays));
    return std::move(problems_);
  }

 private:
  void check_lights() {
    const char* allowed = "are rings, domes, bars, coaxial lights and luminous meshes";
    expect(!scene_.has_tunnel, "lighting." + scene_.tunnel_name, "is a tunnel", allowed);
    for (const NamedLight& light : scene_.lights) {
      const std::string key = "lighting." + light.name;
      expect(!is_surrounding(light.settings), key, "is an environment", allowed);
      expect(
          !std::holds_alternative<IesLightSettings>(light.settings), key, "is measured", allowed);
    }
  }

  void check_surface() {
    const MaterialSettings& material = scene_.material;
    expect_bare_metal();
    if (material.type == MaterialSettings::Type::kConductor) {
      check_width();
    }
    expect(material.texture.roughness_file.empty(),
           "material.texture.roughness_file",
           "changes the roughness from place to place",
           "is none");
    const bool has_pattern = material.pattern.kind != PatternSettings::Kind::kNone;
    expect(!has_pattern || material.pattern.roughness == 0.0,
           "material.pattern.roughness",
           fmt::format("is {:g}", material.pattern.roughness),
           "is 0");
    for (const auto& [name, group] : scene_.defects) {
      expect(group.type != DefectType::kStain || group.stain_roughness_rad == 0.0,
             fmt::format("defects.{}.stain_roughness_deg", name),
             "is not 0",
             "is 0");
    }
  }

  void check_width() {
    const MaterialSettings& material = scene_.material;
    const bool has_alpha = !material.alpha.empty();
    const auto [x, y] = has_alpha ? GgxAlpha<double>{material.alpha.front(), material.alpha.back()}
                                  : alpha_from_roughness(material.roughness, material.anisotropy);
    expect(std::min(x, y) >= kMinDirectAlpha,
           has_alpha ? "material.alpha" : "material.roughness",
           fmt::format("makes a width of {:g}", std::min(x, y)),
           fmt::format("are widths from {:g}", kMinDirectAlpha));
  }
};

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
  if (is_blurred(scene) || is_direct(scene)) {
    return {.name = std::string(method_name(scene.render.method)),
            .numbers = {{"rays_per_axis", scene.render.rays_per_axis}}};
  }
  if (needs_paths(scene)) {
    return {.name = "paths",
            .numbers = {{"samples", paths.samples},
                        {"batches", paths.batches},
                        {"max_reflections", paths.max_reflections}},
            .is_noisy = true};
  }
  const RenderMethod method = scene.render.method;
  return {.name = method == RenderMethod::kSampled ? "sampled" : "integrated",
          .has_closed_mean = method == RenderMethod::kAuto || method == RenderMethod::kClosed};
}

bool is_blurred(const SceneSettings& scene) {
  return scene.render.method == RenderMethod::kBlurred;
}

bool shows_roughness(const SceneSettings& scene) {
  return needs_paths(scene);
}

SceneSettings without_blurred_method(SceneSettings scene) {
  if (is_blurred(scene)) {
    scene.render.method = RenderMethod::kAuto;
  }
  return scene;
}

std::vector<Problem> blurred_problems(const SceneSettings& scene) {
  return BlurredRange(scene).problems();
}

bool is_direct(const SceneSettings& scene) {
  return scene.render.method == RenderMethod::kDirect;
}

std::vector<Problem> direct_problems(const SceneSettings& scene) {
  return DirectRange(scene).problems();
}

SceneSettings rescoring_settings(SceneSettings scene) {
  constexpr int kFreshSeed = 1000003;
  scene.sensor.seed += kFreshSeed;
  if (is_direct(scene)) {
    scene.render.rays_per_axis = std::min(kMaxDirectRays, 2 * scene.render.rays_per_axis);
  } else if (needs_paths(scene)) {
    constexpr int kMoreSamples = 4;  // half the standard error
    constexpr int kMaxSamples = 65535;
    scene.paths.seed += kFreshSeed;
    scene.paths.samples = std::min(kMaxSamples, kMoreSamples * scene.paths.samples);
  } else if (scene.render.method == RenderMethod::kSampled || is_blurred(scene)) {
    scene.render.rays_per_axis *= 2;
  } else {
    scene.render.method = RenderMethod::kIntegrated;
    scene.render.max_direction_error_rad *= 0.25;
  }
  return scene;
}

SceneSettings coarse_settings(SceneSettings scene) {
  if (!needs_paths(scene)) {
    scene.render.method = is_blurred(scene) ? RenderMethod::kBlurred : RenderMethod::kSampled;
    scene.render.rays_per_axis = 1;
  }
  return scene;
}

SceneSettings repeated_settings(SceneSettings scene, int index) {
  constexpr int kFirstSeed = 2000003;
  constexpr int kStride = 1000;  // more than the scans behind one interval
  const int seed = kFirstSeed + kStride * index;
  scene.sensor.seed += seed;
  scene.paths.seed += needs_paths(scene) && !is_direct(scene) ? seed : 0;
  return scene;
}

std::string reflections_text(const PathSettings& paths) {
  return fmt::format(
      "{} reflection{}", paths.max_reflections, paths.max_reflections == 1 ? "" : "s");
}

namespace {

constexpr const char* kHomogeneityNote =
    "Homogeneity is scored on pixels wholly on the part, eroded, without the surroundings of the "
    "defects; h_rms = 1 - standard deviation / mean, h_abs = 1 - mean absolute deviation / mean.";

std::vector<std::string> path_method_notes(const PathSettings& paths) {
  return {
      fmt::format("Light transport: path tracing with {} samples per pixel and at most {} on the "
                  "part; pictures of all lights at power 1 are rendered once per part, camera "
                  "and position of the lights; powers are factors.",
                  paths.samples,
                  reflections_text(paths)),
      kHomogeneityNote,
      fmt::format("Standard errors (scores that end in .error) come from the scatter of {} "
                  "independent pictures. All designs share the same random numbers.",
                  paths.batches)};
}

/// @param rays        what is traced
/// @param integrated  what is done between the rays
/// @param finer       what re-scoring looks at: rescoring_settings()
std::vector<std::string> mirror_method_notes(const std::string& rays,
                                             const std::string& integrated,
                                             const std::string& finer) {
  return {
      fmt::format("Light transport: perfect mirror, {} traced once per part, camera and defects; "
                  "every lighting is evaluated along the kept rays{}.",
                  rays,
                  integrated),
      kHomogeneityNote,
      fmt::format("All designs share the same noise (common random numbers). Re-scored numbers use "
                  "fresh noise and {}.",
                  finer)};
}

std::vector<std::string> blurred_method_notes(int rays_per_axis) {
  const int rays = rays_per_axis * rays_per_axis;
  return {
      fmt::format("Light transport: blurred reflections, the lobe of rough metal summed without "
                  "noise around {} ray{} per pixel; light is reflected once by the part, whose "
                  "light never falls on the part again.",
                  rays,
                  rays == 1 ? "" : "s"),
      kHomogeneityNote,
      fmt::format("All designs share the same noise (common random numbers). Re-scored numbers "
                  "use fresh noise and {} rays per pixel.",
                  4 * rays)};
}

std::vector<std::string> direct_method_notes(const SceneSettings& scene) {
  const int rays = scene.render.rays_per_axis * scene.render.rays_per_axis;
  const int finer_axis = rescoring_settings(scene).render.rays_per_axis;
  return {
      fmt::format("Light transport: direct light of lamps on rough metal, summed without noise at "
                  "{} ray{} per pixel and more where they differ; light that the part reflects "
                  "onto itself is left out.",
                  rays,
                  rays == 1 ? "" : "s"),
      kHomogeneityNote,
      fmt::format("Scores have no standard error of rendering. All designs share the same noise of "
                  "the sensor; re-scored numbers use fresh noise and {} rays per pixel.",
                  finer_axis * finer_axis)};
}

}  // namespace

std::vector<std::string> method_notes(const SceneSettings& scene) {
  if (is_direct(scene)) {
    return direct_method_notes(scene);
  }
  if (needs_paths(scene)) {
    return path_method_notes(scene.paths);
  }
  if (is_blurred(scene)) {
    return blurred_method_notes(scene.render.rays_per_axis);
  }
  const RenderSettings& render = scene.render;
  if (render.method == RenderSettings::Method::kSampled) {
    const int rays = render.rays_per_axis * render.rays_per_axis;
    return mirror_method_notes(
        fmt::format("{} rays per pixel", rays), "", fmt::format("{} rays per pixel", 4 * rays));
  }
  return mirror_method_notes(
      fmt::format("one ray per pixel and the pixel's footprint around it, with more rays where "
                  "directions deviate by more than {:g} mrad,",
                  render.max_direction_error_rad * 1e3),
      ", stripes and edges of the light integrated in closed form",
      "all frames, with directions four times as accurate");
}

}  // namespace glint
