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
  check_part_in_tunnel(*store.build(scene), tunnel, scene.tunnel_name);
  result.traced = store.trace(scene);
  const TracedScene& traced = *result.traced;
  const Sensor sensor(scene.sensor, traced.rays.width_px, traced.rays.height_px);
  std::optional<FringeScores> fringes;
  BestFrames best(traced.defects);
  const auto watch = [&](int index, const ImageF& grey) {
    if (index == 0) {
      fringes = fringe_scores(grey, traced.region, {.nominal_duty = scene.tunnel.duty});
    }
    best.add(grey);
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
  add_scores(result.scores, result.defects);
  for (std::size_t i = 0; i < traced.defects.size(); ++i) {
    result.scores[fmt::format("defects.{}.best_frame", traced.defects[i].label)] =
        best.best()[i].difference;
  }
  add_ray_scores(result, result.scores);
  return result;
}

SceneSettings finer(SceneSettings scene) {
  constexpr int kFreshSeed = 1000003;
  scene.sensor.seed += kFreshSeed;
  scene.render.rays_per_axis = std::min(16, 2 * scene.render.rays_per_axis);
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
