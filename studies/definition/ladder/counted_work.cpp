// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/counted_work.h"

#include <cmath>

#include "studies/definition/render_methods.h"

namespace glint {
namespace {

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

double pixels_of(const SceneSettings& scene) {
  return static_cast<double>(scene.camera.width_px) * scene.camera.height_px;
}

bool is_hollow(double radius_mm) {
  return radius_mm < 0.0 && std::isfinite(radius_mm);
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
  if (render.method == RenderSettings::Method::kSampled) {
    const double rays = static_cast<double>(render.rays_per_axis) * render.rays_per_axis;
    return rays * (WorkPerPixel::kRay + WorkPerPixel::kRayFrame * positions) +
           WorkPerPixel::kTraced * rays;
  }
  // Rays are refined where neighbours part by more than the error: along two axes, each as often as
  // the root of what is allowed.
  const double traced = WorkPerPixel::kTraced * kUsual_rad / render.max_direction_error_rad;
  const bool has_frames = render.method == RenderSettings::Method::kIntegrated;
  return WorkPerPixel::kClosed + traced + (has_frames ? WorkPerPixel::kFrame * positions : 0.0);
}

}  // namespace

bool may_see_itself(const SceneSettings& scene) {
  const PartSettings& part = scene.part;
  switch (part.shape) {
    case PartSettings::Shape::kSpurGear:
    case PartSettings::Shape::kMesh:
      return true;
    case PartSettings::Shape::kStrip:
      return is_hollow(part.radius_along_mm) || is_hollow(part.radius_across_mm);
    default:
      return false;
  }
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
  return is_direct(scene) ? counted_work(rescoring_settings(scene)) / counted_work(scene)
                          : kOfSamples;
}

}  // namespace glint
