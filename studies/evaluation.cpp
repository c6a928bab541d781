// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/evaluation.h"

#include <algorithm>

#include <fmt/format.h>

namespace glint {
namespace {

/// Grey levels per full scale decide what can be told apart when the sensor adds no noise.
double sigma_floor(const SensorSettings& sensor) {
  constexpr double kSmallest = 1e-4;
  return std::max(kSmallest, noise_floor(sensor));
}

/// For each frame and defect, the values of the defect's own pixels.
using FlawlessFrames = std::vector<std::vector<std::vector<float>>>;

/// What the defects' pixels would show without the defects, and without noise.
FlawlessFrames flawless_frames(const TracedScene& traced,
                               const Tunnel& tunnel,
                               const SceneSettings& scene) {
  FlawlessFrames frames(static_cast<std::size_t>(scene.scan.positions));
  SensorSettings quiet = scene.sensor;
  quiet.full_well_e = quiet.read_noise_e = quiet.dark_e = 0.0;
  const double dark = scene.sensor.full_well_e > 0.0
                          ? scene.sensor.dark_e * scene.sensor.gain / scene.sensor.full_well_e
                          : 0.0;
  for (std::size_t k = 0; k < traced.defects.size(); ++k) {
    const RayCache& rays = traced.flawless[k];
    const DefectView& view = traced.views[k];
    const auto keep = [&](int index, const ImageF& grey) {
      std::vector<float>& values = frames[static_cast<std::size_t>(index)].emplace_back();
      for (const std::size_t pixel : traced.defects[k].inside) {
        const auto at = static_cast<int>(pixel);
        const float value =
            grey(at % traced.rays.width_px - view.left_px, at / traced.rays.width_px - view.top_px);
        values.push_back(std::min(1.0F, value + static_cast<float>(dark)));
      }
    };
    take_scan(rays,
              tunnel,
              Sensor(quiet, rays.width_px, rays.height_px),
              scene.scan,
              traced.camera_in_world_mm,
              keep);
  }
  return frames;
}

void add_ray_scores(const Evaluation& evaluation, Scores& scores) {
  const RayCounts& counts = evaluation.traced->rays.counts;
  const auto part = static_cast<double>(counts.part);
  scores["view.hidden_share"] = evaluation.scan.hidden_share;
  scores["rays.followed_share"] = static_cast<double>(counts.followed) / part;
  scores["rays.blocked_share"] = static_cast<double>(counts.blocked) / part;
}

}  // namespace

Evaluation evaluate(SceneStore& store, const SceneSettings& scene, const FrameConsumer& consume) {
  Evaluation result;
  const Tunnel tunnel(scene.tunnel);
  check_part_in_tunnel(*store.build(scene), tunnel, scene.scan, scene.tunnel_name);
  result.traced = store.trace(scene);
  const TracedScene& traced = *result.traced;
  const Sensor sensor(scene.sensor, traced.rays.width_px, traced.rays.height_px);
  std::optional<FringeScores> fringes;
  BestFrames best(traced.defects);
  const FlawlessFrames flawless = flawless_frames(traced, tunnel, scene);
  const auto watch = [&](int index, const ImageF& grey) {
    if (index == 0) {
      fringes = fringe_scores(grey, traced.region, {.nominal_duty = scene.tunnel.duty});
    }
    best.add(grey, flawless[static_cast<std::size_t>(index)]);
    if (consume) {
      consume(index, grey);
    }
  };
  result.scan =
      take_scan(traced.rays, tunnel, sensor, scene.scan, traced.camera_in_world_mm, watch);
  add_scores(result.scores,
             homogeneity(result.scan.aspect,
                         result.scan.sums.clipped_frames,
                         result.scan.sums.frames,
                         traced.region,
                         scene.metrics));
  if (fringes) {
    add_scores(result.scores, *fringes);
  }
  result.defects =
      defect_scores(result.scan.aspect, traced.defects, sigma_floor(scene.sensor), scene.metrics);
  for (std::size_t i = 0; i < result.defects.size(); ++i) {
    result.defects[i].best_frame = best.best()[i].difference;
    result.defects[i].change = best.best()[i].change;
  }
  add_scores(result.scores, result.defects);
  add_ray_scores(result, result.scores);
  return result;
}

SceneSettings finer(SceneSettings scene) {
  constexpr int kFreshSeed = 1000003;
  scene.sensor.seed += kFreshSeed;
  scene.render.rays_per_axis *= 2;
  return scene;
}

std::vector<std::string> defect_labels(const SceneSettings& scene) {
  std::vector<std::string> labels;
  for (const auto& [name, group] : scene.defects) {
    for (std::size_t i = 0; i < group.x_mm.size(); ++i) {
      labels.push_back(fmt::format("{}_{}", name, i + 1));
    }
  }
  return labels;
}

}  // namespace glint
