// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/evaluation/evaluation.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>

#include "metrics/aspect_image/noise_variance.h"
#include "metrics/lighting_scores.h"
#include "metrics/statistics/estimate.h"
#include "simulator/render/corner_rays/affordable_cells.h"
#include "studies/coverage/scene_coverage.h"
#include "studies/evaluation/evaluation_parts.h"
#include "studies/evaluation/lighting_totals.h"
#include "studies/inspection_line/visibility.h"
#include "studies/reach/reach_scores.h"
#include "studies/reference/reference_scores.h"

namespace glint {
namespace {

/// Scores of the mean image over the region, and those of the stripes.
void add_mean_scores(const ScenePicture& picture,
                     const MeanImage& mean,
                     const WantedScores& wanted,
                     const std::optional<FringeScores>& fringes,
                     Scores& scores) {
  const SceneSettings& scene = picture.scene();
  const TracedScene& traced = *picture.traced();
  const Mask& region = traced.region.mask;
  Homogeneity uniformity = homogeneity(
      mean.aspect, mean.clipped_frames, mean.frames, traced.region, scene.metrics, wanted.robust);
  if (!mean.deviation.empty()) {
    uniformity = with_noise_variance(uniformity, mean.aspect, mean.deviation, region);
  }
  add_scores(scores, uniformity);
  if (wanted.family) {
    const FamilyScales scales = scales_of(scene, traced.defects, fringes);
    add_scores(scores, homogeneity_family(mean.aspect, region, scales, scene.metrics));
  }
  if (fringes) {
    add_scores(scores, *fringes);
  }
}

/// What one picture scores, from all its samples or without a batch of them.
struct Scored {
  Scores scores;
  MeanImage mean;
  std::vector<DefectScores> defects;
};

Scored score(const ScenePicture& picture,
             const WantedScores& wanted,
             const FrameConsumer& consume,
             double smallest_change,
             std::optional<std::size_t> without = {}) {
  constexpr double kMeanFloor = 0.01;
  const SceneSettings& scene = picture.scene();
  const TracedScene& traced = *picture.traced();
  const bool is_whole = picture.has_whole_frames(static_cast<bool>(consume), wanted.fringes);
  const bool has_fringes = wanted.fringes && picture.has_stripes() && is_whole;
  std::optional<FringeScores> fringes;
  BestFrames best(traced.defects, kMeanFloor, smallest_change);
  const auto watch = [&](int index, const ImageF& grey) {
    if (index == 0 && has_fringes) {
      fringes = fringe_scores(grey, traced.region.mask, {.nominal_duty = scene.tunnel.duty});
    }
    if (wanted.defects) {
      best.add(grey, wanted.changes ? picture.flawless(index, without) : DefectValues());
    }
    if (consume) {
      consume(index, grey);
    }
  };
  const bool is_watching = has_fringes || wanted.defects || consume;
  Scored result;
  result.mean = picture.mean({.watch = is_watching ? FrameConsumer(watch) : FrameConsumer(),
                              .has_whole_frames = is_whole,
                              .keeps_closed_form = !wanted.gradients.paths.empty(),
                              .without = without});
  add_mean_scores(picture, result.mean, wanted, fringes, result.scores);
  if (wanted.defects) {
    result.defects = scored_defects(result.mean.aspect, traced.defects, best, scene);
    add_scores(result.scores, result.defects);
  }
  if (!wanted.changes) {
    std::erase_if(result.scores, [](const auto& row) { return needs_flawless(row.first); });
  }
  return result;
}

std::vector<Scores> scores_without_batch(const ScenePicture& picture,
                                         const WantedScores& wanted,
                                         double smallest_change,
                                         ThreadPool& pool) {
  const auto count = static_cast<std::int64_t>(picture.batches());
  return pool.map<Scores>(count, [&](std::int64_t batch) {
    return score(picture, wanted, {}, smallest_change, static_cast<std::size_t>(batch)).scores;
  });
}

/// Its values without one batch each; empty where one of them lacks it.
std::vector<double> values_without(const std::vector<Scores>& without, const std::string& name) {
  std::vector<double> values;
  for (const Scores& one : without) {
    const auto found = one.find(name);
    if (found != one.end()) {
      values.push_back(found->second);
    }
  }
  return values.size() == without.size() ? values : std::vector<double>{};
}

/// "<score>.error" for each score that every set of batches has.
void add_errors(const std::vector<Scores>& without, Scores& scores) {
  Scores errors;
  for (const auto& [name, value] : scores) {
    if (const std::vector<double> values = values_without(without, name); !values.empty()) {
      errors[error_name(name)] = jackknife_error(values);
    }
  }
  scores.merge(errors);
}

/// Of these figures, of one defect or of all; those that count what is above a threshold are not.
bool is_smooth_contrast(const std::string& name) {
  constexpr std::array<std::string_view, 7> kContrasts = {
      "cnr", "weber", "peak", "michelson", "dprime", "signature", "rms_contrast"};
  return name.starts_with("defects.") &&
         std::ranges::any_of(kContrasts, [&](std::string_view end) { return name.ends_with(end); });
}

/// Takes the bias of noise off contrasts: B t - (B - 1) mean of t_b (M. Quenouille, Biometrika 43,
/// 1956; docs/theory/path_tracing.md, "Bias of scores").
void take_bias_off(const std::vector<Scores>& without, Scores& scores) {
  for (auto& [name, value] : scores) {
    const std::vector<double> values =
        is_smooth_contrast(name) ? values_without(without, name) : std::vector<double>{};
    const auto count = static_cast<double>(values.size());
    if (!values.empty()) {
      const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
      value = count * value - (count - 1.0) * mean;
    }
  }
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

/// How the camera sees the part through the tunnel's slot.
/// @return the slot's margin, where it is wanted
SlotMargin add_view_scores(const ScenePicture& picture,
                           const MeanImage& mean,
                           bool wants_slot,
                           Scores& scores) {
  constexpr int kUsualCells = 16;
  const std::optional<SlotMargin> slot =
      wants_slot ? picture.find_slot_margin() : std::optional<SlotMargin>();
  if (slot) {
    scores["view.slot_margin_mm"] = slot->margin_mm;
  }
  if (mean.hidden_share) {
    scores["view.hidden_share"] = *mean.hidden_share;
  }
  if (const RayCounts* counts = picture.ray_counts()) {
    const auto part = static_cast<double>(counts->part);
    scores["rays.followed_share"] = static_cast<double>(counts->followed) / part;
    scores["rays.blocked_share"] = static_cast<double>(counts->blocked) / part;
    if (const int cells = max_cells_of(picture.traced()->corners); cells < kUsualCells) {
      scores["rays.max_cells"] = cells;
    }
  }
  return slot.value_or(SlotMargin());
}

Gradients gradients_of_mean(const ScenePicture& picture,
                            const MeanImage& mean,
                            const SlotMargin& slot,
                            const WantedGradients& wanted,
                            ThreadPool& pool) {
  const ScanState state = {.traced = *picture.traced(),
                           .footprints = *mean.closed->footprints,
                           .sensor = *mean.closed->sensor,
                           .plan = mean.closed->plan,
                           .cells = mean.closed->cells,
                           .aspect = mean.aspect,
                           .sigma_floor = sigma_floor(picture.scene().sensor),
                           .slot = slot,
                           .deviation = mean.deviation.empty() ? nullptr : &mean.deviation};
  return gradients_of(picture.scene(), state, wanted, pool);
}

/// Scores that the picture of the first viewpoint does not give.
Scores scores_beside(SceneStore& store, const SceneSettings& scene, const WantedScores& wanted) {
  Scores scores;
  if (wanted.coverage) {
    scores.merge(coverage_scores(store, scene));
  }
  if (wanted.reference) {
    scores.merge(reference_scores(
        store, scene, wanted.inner_edges ? InnerEdgeScore::kMeasured : InnerEdgeScore::kLeftOut));
  }
  if (wanted.reach) {
    scores.merge(reach_scores(store, scene));
  }
  if (wanted.lighting || scene.cost) {
    add_scores(scores, lighting_totals(scene));
  }
  return scores;
}

/// Whether the picture of the first viewpoint gives it.
bool is_of_picture(const std::string& name) {
  return !(is_of_coverage(name) || is_of_reference(name) || is_of_reach(name) ||
           is_of_lighting(name));
}

}  // namespace

WantedScores WantedScores::of_one_scan() const {
  WantedScores wanted = *this;
  wanted.trials.clear();
  return wanted;
}

WantedScores wanted_by(const Goal& goal) {
  WantedScores wanted = {
      .fringes = false, .defects = false, .robust = false, .slot = false, .picture = false};
  const auto look_at = [&](const std::string& name) {
    wanted.coverage = wanted.coverage || is_of_coverage(name);
    wanted.reference = wanted.reference || is_of_reference(name);
    wanted.inner_edges = wanted.inner_edges || name == "overlap.edge_distance_px";
    wanted.reach = wanted.reach || is_of_reach(name);
    wanted.lighting = wanted.lighting || is_of_lighting(name);
    wanted.picture = wanted.picture || is_of_picture(name);
    wanted.family = wanted.family || is_of_family(name);
    wanted.fringes = wanted.fringes || needs_fringes(name);
    wanted.robust = wanted.robust || without_bound(name) == "homogeneity.robust";
    wanted.defects = wanted.defects || name.starts_with("defects.");
    wanted.slot = wanted.slot || name == "view.slot_margin_mm";
    if (is_of_line(name) || is_bound(name)) {
      wanted.trials.push_back(name);
    }
  };
  for (const Objective& objective : objectives_of(goal)) {
    look_at(objective.name);
  }
  for (const Constraint& constraint : goal.constraints) {
    look_at(constraint.name);
  }
  return wanted;
}

WantedScores needed_by(const Goal& goal) {
  WantedScores wanted = wanted_by(goal);
  const auto needs = [](const auto& row) { return needs_flawless(row.name); };
  wanted.changes = std::ranges::any_of(objectives_of(goal), needs) ||
                   std::ranges::any_of(goal.constraints, needs);
  return wanted;
}

WantedScores wanted_with_gradients(const Goal& goal, const SearchSpace& space) {
  WantedScores wanted = wanted_by(goal);
  for (const Objective& objective : objectives_of(goal)) {
    wanted.gradients.scores.push_back(objective.name);
  }
  for (const Constraint& constraint : goal.constraints) {
    wanted.gradients.scores.push_back(constraint.name);
  }
  for (const Variable& variable : space.variables) {
    wanted.gradients.paths.push_back(variable.name);
  }
  return wanted;
}

Evaluation evaluate(const ScenePicture& picture,
                    ThreadPool& pool,
                    const FrameConsumer& consume,
                    const WantedScores& wanted) {
  constexpr double kSigmas = 5.0;
  double smallest_change = change_threshold(picture.scene());
  if (wanted.defects && wanted.changes) {
    smallest_change = std::max(smallest_change, kSigmas * picture.change_noise());
  }
  Scored scored = score(picture, wanted, consume, smallest_change);
  Evaluation result = {.scores = std::move(scored.scores), .traced = picture.traced()};
  const bool is_debiased = picture.scene().paths.has_bias_taken_off;
  if ((wanted.errors || is_debiased) && picture.batches() > 1) {
    result.without_batch = scores_without_batch(picture, wanted, smallest_change, pool);
  }
  if (is_debiased) {
    take_bias_off(result.without_batch, result.scores);
  }
  if (wanted.errors && picture.batches() > 1) {
    add_errors(result.without_batch, result.scores);
  }
  add_scores(result.scores, totals_of(result.traced->part->made));
  const SlotMargin slot = add_view_scores(picture, scored.mean, wanted.slot, result.scores);
  if (scored.mean.closed) {
    result.gradients = gradients_of_mean(picture, scored.mean, slot, wanted.gradients, pool);
  }
  result.form = scored.mean.form;
  result.aspect = std::move(scored.mean.aspect);
  result.defects = std::move(scored.defects);
  return result;
}

Evaluation evaluate(SceneStore& store,
                    const SceneSettings& scene,
                    const FrameConsumer& consume,
                    const WantedScores& wanted) {
  if (!wanted.picture) {
    return {.scores = scores_beside(store, scene, wanted)};
  }
  const auto picture = picture_of(store,
                                  scene,
                                  {.has_flawless = wanted.defects && wanted.changes,
                                   .has_derivatives = !wanted.gradients.scores.empty()});
  Evaluation result = evaluate(*picture, store.pool(), consume, wanted);
  const bool is_whole = picture->has_whole_frames(static_cast<bool>(consume), wanted.fringes);
  add_scan_bounds(store, picture->repeated(is_whole), wanted, result.scores);
  if (!wanted.trials.empty()) {
    result.scores.merge(
        visibility_scores(store, picture->scene(), wanted.trials, wanted.first_part));
  }
  result.scores.merge(scores_beside(store, scene, wanted));
  return result;
}

}  // namespace glint
