// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/evaluation/evaluation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "metrics/aspect_image/scatter.h"
#include "metrics/statistics/estimate.h"
#include "studies/evaluation/evaluation_parts.h"
#include "studies/evaluation/path_evaluation.h"
#include "studies/inspection_line/visibility.h"

namespace glint {
namespace {

/// For each frame and defect, the values of the defect's own pixels.
using FlawlessFrames = std::vector<std::vector<std::vector<float>>>;

/// What the defects' pixels would show without the defects, and without noise.
FlawlessFrames flawless_frames(SceneStore& store,
                               const std::shared_ptr<const TracedScene>& scene_traced,
                               const Tunnel& tunnel,
                               const SceneSettings& scene) {
  const TracedScene& traced = *scene_traced;
  FlawlessFrames frames(static_cast<std::size_t>(scene.scan.positions));
  const double dark = dark_grey(scene.sensor);
  for (std::size_t k = 0; k < traced.defects.size(); ++k) {
    const DefectView& view = traced.views[k];
    const auto keep = [&](int index, const ImageF& grey) {
      std::vector<float>& values = frames[static_cast<std::size_t>(index)].emplace_back();
      for (const std::size_t pixel : traced.defects[k].inside) {
        const auto at = static_cast<int>(pixel);
        const int width = traced.seen().width_px;
        const float value = grey(at % width - view.left_px, at / width - view.top_px);
        values.push_back(std::min(1.0F, value + static_cast<float>(dark)));
      }
    };
    const Eigen::Vector3d& camera_mm = traced.camera_in_world_mm;
    if (traced.is_sampled()) {
      const RayCache& rays = traced.flawless[k];
      take_scan(rays,
                tunnel,
                quiet_sensor(scene.sensor, rays.width_px, rays.height_px),
                scene.scan,
                camera_mm,
                keep);
    } else {
      const CornerRays& rays = traced.flawless_corners[k];
      const Footprints footprints(rays, tunnel, scene.scan, store.meet(scene_traced, rays, tunnel));
      scan_integrated(footprints, quiet_sensor(scene.sensor, rays.width_px, rays.height_px), keep);
    }
  }
  return frames;
}

/// The scan as the scene's method has it.
struct Scan {
  ImageF aspect;
  ImageF deviation;  ///< of the aspect image's pixels; empty: none
  Image<std::uint16_t> clipped_frames;
  double hidden_share = 0.0;
  ScanForm form;
  Gradients gradients;
};

Scan as_scan(ScanResult result) {
  Scan scan = {.aspect = std::move(result.aspect),
               .clipped_frames = std::move(result.sums.clipped_frames),
               .hidden_share = result.hidden_share};
  scan.form.frame_pixels = static_cast<int>(scan.aspect.size());
  return scan;
}

/// How a scene is to be scanned.
struct ScanTask {
  bool needs_frames = false;
  FrameConsumer watch = {};
  SlotMargin slot = {};
  WantedGradients gradients = {};
};

Scan scan_scene(SceneStore& store,
                const std::shared_ptr<const TracedScene>& scene_traced,
                const Tunnel& tunnel,
                const SceneSettings& scene,
                const ScanTask& task) {
  const TracedScene& traced = *scene_traced;
  const SeenPart& seen = traced.seen();
  const Sensor sensor(scene.sensor, seen.width_px, seen.height_px);
  const Eigen::Vector3d& camera_mm = traced.camera_in_world_mm;
  if (traced.is_sampled()) {
    return as_scan(take_scan(traced.rays, tunnel, sensor, scene.scan, camera_mm, task.watch));
  }
  const Footprints footprints(
      traced.corners, tunnel, scene.scan, store.meet(scene_traced, traced.corners, tunnel));
  if (task.needs_frames) {
    return as_scan(scan_integrated(footprints, sensor, task.watch));
  }
  const Mask none;
  const ScanPlan plan = plan_scan(footprints,
                                  sensor,
                                  traced.region,
                                  task.watch ? traced.watched : none,
                                  scene.render.reflectance);
  ClosedScan closed = scan_closed(footprints, sensor, plan, task.watch);
  Gradients gradients;
  if (!task.gradients.paths.empty()) {
    const ScanState state = {.traced = traced,
                             .footprints = footprints,
                             .sensor = sensor,
                             .plan = plan,
                             .cells = closed.cells,
                             .aspect = closed.aspect,
                             .sigma_floor = sigma_floor(scene.sensor),
                             .slot = task.slot,
                             .deviation = closed.deviation.empty() ? nullptr : &closed.deviation};
    gradients = gradients_of(scene, state, task.gradients, store.pool());
  }
  return {.aspect = std::move(closed.aspect),
          .deviation = std::move(closed.deviation),
          .clipped_frames = std::move(closed.clipped_frames),
          .hidden_share = footprints.hidden_share(),
          .form = closed.form,
          .gradients = std::move(gradients)};
}

/// Bounds of scores of one scan, from scans with other noise; the scan itself is the first of them.
void add_scan_bounds(SceneStore& store,
                     SceneSettings scene,
                     const WantedScores& wanted,
                     Scores& scores) {
  WantedScores more = {
      .fringes = false, .defects = false, .robust = false, .slot = false, .errors = false};
  std::map<std::string, std::vector<double>> values;
  for (const std::string& name : wanted.trials) {
    const std::string whole(without_bound(name));
    if (interval_of(name) == ScoreInterval::kScans && is_bound(name) && scores.contains(whole)) {
      more.family = more.family || is_of_family(name);
      more.fringes = more.fringes || needs_fringes(name);
      more.defects = more.defects || name.starts_with("defects.");
      more.robust = more.robust || whole == "homogeneity.robust";
      values[whole] = {scores.at(whole)};
    }
  }
  if (values.empty()) {
    return;
  }
  // One after the other: a scan that waits for threads must not begin another one.
  for (int k = 1; k < scene.inspection.trials.noise_seeds; ++k) {
    ++scene.sensor.seed;
    const Scores other = evaluate(store, scene, {}, more).scores;
    for (auto& [name, list] : values) {
      list.push_back(other.at(name));
    }
  }
  for (const auto& [name, list] : values) {
    const Estimate mean = mean_of(list, scene.inspection.trials.confidence);
    scores[name + ".low"] = mean.low;
    scores[name + ".high"] = mean.high;
  }
}

/// What a simulated line says.
void add_line_scores(SceneStore& store,
                     const SceneSettings& scene,
                     const WantedScores& wanted,
                     Scores& scores) {
  if (!wanted.trials.empty()) {
    scores.merge(visibility_scores(store, scene, wanted.trials, wanted.first_part));
  }
}

void add_ray_scores(const RayCounts& counts, double hidden_share, Scores& scores) {
  const auto part = static_cast<double>(counts.part);
  scores["view.hidden_share"] = hidden_share;
  scores["rays.followed_share"] = static_cast<double>(counts.followed) / part;
  scores["rays.blocked_share"] = static_cast<double>(counts.blocked) / part;
}

}  // namespace

WantedScores WantedScores::of_one_scan() const {
  WantedScores wanted = *this;
  wanted.trials.clear();
  return wanted;
}

WantedScores wanted_by(const Goal& goal) {
  WantedScores wanted = {.fringes = false, .defects = false, .robust = false, .slot = false};
  const auto look_at = [&](const std::string& name) {
    wanted.family = wanted.family || is_of_family(name);
    wanted.fringes = wanted.fringes || needs_fringes(name);
    wanted.robust = wanted.robust || without_bound(name) == "homogeneity.robust";
    wanted.defects = wanted.defects || name.starts_with("defects.");
    wanted.slot = wanted.slot || name == "view.slot_margin_mm";
    if (is_of_line(name) || is_bound(name)) {
      wanted.trials.push_back(name);
    }
  };
  look_at(goal.objective.name);
  for (const Constraint& constraint : goal.constraints) {
    look_at(constraint.name);
  }
  return wanted;
}

WantedScores wanted_with_gradients(const Goal& goal, const SearchSpace& space) {
  WantedScores wanted = wanted_by(goal);
  wanted.gradients.scores.push_back(goal.objective.name);
  for (const Constraint& constraint : goal.constraints) {
    wanted.gradients.scores.push_back(constraint.name);
  }
  for (const Variable& variable : space.variables) {
    wanted.gradients.paths.push_back(variable.name);
  }
  return wanted;
}

Evaluation evaluate(SceneStore& store,
                    const SceneSettings& scene,
                    const FrameConsumer& consume,
                    const WantedScores& wanted) {
  using Method = RenderSettings::Method;
  if (needs_paths(scene)) {
    const SceneSettings seen = first_view(store, scene);
    Evaluation result = evaluate_paths(store, seen, consume, wanted);
    add_scan_bounds(store, seen, wanted, result.scores);
    add_line_scores(store, seen, wanted, result.scores);
    return result;
  }
  Evaluation result;
  const Tunnel tunnel(scene.tunnel);
  check_part_in_tunnel(*store.build(scene), tunnel, scene.scan, scene.tunnel_name);
  result.traced = store.trace(scene);
  const TracedScene& traced = *result.traced;
  const bool needs_frames = consume || scene.render.method == Method::kIntegrated ||
                            (wanted.fringes && scene.render.method != Method::kClosed);
  const bool has_fringes = wanted.fringes && (traced.is_sampled() || needs_frames);
  std::optional<FringeScores> fringes;
  constexpr double kMeanFloor = 0.01;
  BestFrames best(traced.defects, kMeanFloor, least_change(scene));
  FlawlessFrames flawless;
  if (wanted.defects) {
    flawless = flawless_frames(store, result.traced, tunnel, scene);
  }
  const auto watch = [&](int index, const ImageF& grey) {
    if (index == 0 && has_fringes) {
      fringes = fringe_scores(grey, traced.region.mask, {.nominal_duty = scene.tunnel.duty});
    }
    if (wanted.defects) {
      best.add(grey, flawless[static_cast<std::size_t>(index)]);
    }
    if (consume) {
      consume(index, grey);
    }
  };
  const bool is_watching = has_fringes || wanted.defects || consume;
  SlotMargin slot;
  if (wanted.slot) {
    slot = slot_margin(traced.seen(), traced.region.mask, tunnel, traced.camera_in_world_mm);
    result.scores["view.slot_margin_mm"] = slot.margin_mm;
  }
  Scan scan = scan_scene(store,
                         result.traced,
                         tunnel,
                         scene,
                         {.needs_frames = needs_frames,
                          .watch = is_watching ? FrameConsumer(watch) : FrameConsumer(),
                          .slot = slot,
                          .gradients = wanted.gradients});
  result.form = scan.form;
  result.gradients = std::move(scan.gradients);
  Homogeneity evenness = homogeneity(scan.aspect,
                                     scan.clipped_frames,
                                     scene.scan.positions,
                                     traced.region,
                                     scene.metrics,
                                     wanted.robust);
  if (!scan.deviation.empty()) {
    evenness = with_scatter(evenness, scan.aspect, scan.deviation, traced.region.mask);
  }
  add_scores(result.scores, evenness);
  if (wanted.family) {
    const FamilyScales scales = scales_of(scene, traced.defects, fringes);
    add_scores(result.scores,
               homogeneity_family(scan.aspect, traced.region.mask, scales, scene.metrics));
  }
  if (fringes) {
    add_scores(result.scores, *fringes);
  }
  if (wanted.defects) {
    result.defects = scored_defects(scan.aspect, traced.defects, best, scene);
    add_scores(result.scores, result.defects);
  }
  add_scores(result.scores, totals_of(traced.part->made));
  add_ray_scores(traced.counts(), scan.hidden_share, result.scores);
  result.aspect = std::move(scan.aspect);
  SceneSettings same_form = scene;
  if (needs_frames && !traced.is_sampled()) {
    same_form.render.method = Method::kIntegrated;  // bounds of what was scored, not of a twin
  }
  add_scan_bounds(store, same_form, wanted, result.scores);
  add_line_scores(store, scene, wanted, result.scores);
  return result;
}

SceneSettings finer(SceneSettings scene) {
  using Method = RenderSettings::Method;
  constexpr int kFreshSeed = 1000003;
  scene.sensor.seed += kFreshSeed;
  if (needs_paths(scene)) {
    constexpr int kMoreSamples = 4;  // half the standard error
    constexpr int kMostSamples = 65535;
    scene.paths.seed += kFreshSeed;
    scene.paths.samples = std::min(kMostSamples, kMoreSamples * scene.paths.samples);
  } else if (scene.render.method == Method::kSampled) {
    scene.render.rays_per_axis *= 2;
  } else {
    scene.render.method = Method::kIntegrated;
    scene.render.max_direction_error_rad *= 0.25;
  }
  return scene;
}

}  // namespace glint
