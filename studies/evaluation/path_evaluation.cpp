// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/evaluation/path_evaluation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/error.h"
#include "core/image/spans.h"
#include "simulator/render/wall/hidden_pixels.h"
#include "studies/evaluation/evaluation_parts.h"
#include "studies/imaging/frame_exposure.h"
#include "studies/imaging/path_lights.h"
#include "studies/imaging/path_picture.h"
#include "studies/inspection_line/visibility.h"

namespace glint {
namespace {

/// What can be told of a scene by path tracing.
void check_scene(const SceneSettings& scene, const WantedScores& wanted) {
  if (!scene.has_tunnel && scene.lights.empty()) {
    throw ConfigError("lighting: holds no light, scores need one");
  }
  if (!scene.paths.has_light) {
    throw ConfigError("render.paths.light: is false, scores need light");
  }
  if (!wanted.gradients.scores.empty()) {
    throw ConfigError(
        "search.algorithm: needs derivatives, which path-traced scenes do not have; allowed are "
        "algorithms without");
  }
}

/// The box around some pixels of the picture, and so much around it.
PixelWindow window_around(const std::vector<std::size_t>& pixels,
                          int margin_px,
                          const SeenPart& seen) {
  int left = seen.width_px;
  int top = seen.height_px;
  int right = 0;
  int bottom = 0;
  for (const std::size_t pixel : pixels) {
    const int x = static_cast<int>(pixel) % seen.width_px;
    const int y = static_cast<int>(pixel) / seen.width_px;
    left = std::min(left, x);
    right = std::max(right, x + 1);
    top = std::min(top, y);
    bottom = std::max(bottom, y + 1);
  }
  left = std::max(0, left - margin_px);
  top = std::max(0, top - margin_px);
  right = std::min(seen.width_px, right + margin_px);
  bottom = std::min(seen.height_px, bottom + margin_px);
  return {.left_px = left, .top_px = top, .width_px = right - left, .height_px = bottom - top};
}

/// The flawless picture around the defects, as a sensor without noise sees it.
class FlawlessWindows {
 public:
  FlawlessWindows(SceneStore& store, const SceneSettings& scene, const TracedScene& traced)
      : defects_(traced.defects),
        sensor_(quiet_sensor(scene.sensor, traced.seen().width_px, traced.seen().height_px)),
        dark_(static_cast<float>(dark_grey(scene.sensor))) {
    Mask inside(traced.seen().width_px, traced.seen().height_px);
    std::vector<PixelWindow> windows;
    for (const DefectPixels& defect : defects_) {
      windows.push_back(window_around(defect.inside, sensor_.blur_radius_px(), traced.seen()));
      for (const std::size_t pixel : defect.inside) {
        inside.values()[pixel] = 1;
      }
    }
    seen_ = spans_of(inside);
    lit_ = spans_of(dilated(inside, sensor_.blur_radius_px()));
    picture_ = store.flawless_picture(scene, windows);
  }

  const PathPicture& picture() const { return *picture_; }

  /// For each defect the values of its own pixels.
  std::vector<std::vector<float>> values(int frame,
                                         const FrameFactors& factors,
                                         std::optional<std::size_t> without) const {
    const std::vector<ImageF> radiance = channel_radiances(*picture_, factors, without, lit_);
    const ImageF grey = mean_of_channels(expose_channels(sensor_, radiance, frame, seen_));
    std::vector<std::vector<float>> values;
    for (const DefectPixels& defect : defects_) {
      std::vector<float>& of_defect = values.emplace_back();
      for (const std::size_t pixel : defect.inside) {
        of_defect.push_back(std::min(1.0F, grey.values()[pixel] + dark_));
      }
    }
    return values;
  }

 private:
  std::span<const DefectPixels> defects_;
  Sensor sensor_;
  float dark_ = 0.0F;
  Spans seen_;  ///< pixels of the defects
  Spans lit_;   ///< and those that are blurred into them
  std::shared_ptr<const PathPicture> picture_;
};

/// What one set of samples scores.
struct Scored {
  Scores scores;
  ImageF aspect;
  std::vector<DefectScores> defects;
};

class PathScoring {
 public:
  PathScoring(SceneStore& store,
              const SceneSettings& scene,
              const WantedScores& wanted,
              const TracedScene& traced)
      : scene_(scene),
        wanted_(wanted),
        traced_(traced),
        sensor_(scene.sensor, traced.seen().width_px, traced.seen().height_px),
        picture_(store.picture(scene)),
        frames_(frame_factors(scene, picture_->unit_power_w)),
        least_change_(least_change(scene)) {
    if (wanted.defects && !traced.defects.empty()) {
      flawless_.emplace(store, scene, traced);
      constexpr double kSigmas = 5.0;
      least_change_ = std::max(least_change_, kSigmas * change_noise());
    }
  }

  /// @param without  a batch that is left out; empty: all samples
  Scored score(std::optional<std::size_t> without, const FrameConsumer& consume = {}) const;

  std::size_t batches() const { return picture_->batches.size(); }

 private:
  double change_noise() const;
  double radiance_change(std::size_t pixel,
                         const FrameFactors& factors,
                         std::optional<std::size_t> without) const;

  const SceneSettings& scene_;
  const WantedScores& wanted_;
  const TracedScene& traced_;
  Sensor sensor_;
  std::shared_ptr<const PathPicture> picture_;
  std::vector<FrameFactors> frames_;
  std::optional<FlawlessWindows> flawless_;
  double least_change_ = 0.0;
};

double PathScoring::radiance_change(std::size_t pixel,
                                    const FrameFactors& factors,
                                    std::optional<std::size_t> without) const {
  return pixel_radiance(*picture_, factors, pixel, without) -
         pixel_radiance(flawless_->picture(), factors, pixel, without);
}

/// Standard deviation that the paths' noise gives to the change of a defect's pixel in a frame,
/// root of the mean square over all of them; before the blur, which only makes it smaller.
double PathScoring::change_noise() const {
  if (batches() < 2) {
    return 0.0;
  }
  double squares = 0.0;
  std::int64_t count = 0;
  std::vector<double> without_one(batches());
  for (const FrameFactors& factors : frames_) {
    for (const DefectPixels& defect : traced_.defects) {
      for (const std::size_t pixel : defect.inside) {
        for (std::size_t b = 0; b < batches(); ++b) {
          without_one[b] = radiance_change(pixel, factors, b);
        }
        const double error = jackknife_error(without_one);
        squares += error * error;
        ++count;
      }
    }
  }
  return scene_.sensor.exposure * scene_.sensor.gain *
         std::sqrt(squares / static_cast<double>(std::max<std::int64_t>(1, count)));
}

Scored PathScoring::score(std::optional<std::size_t> without, const FrameConsumer& consume) const {
  constexpr double kMeanFloor = 0.01;
  BestFrames best(traced_.defects, kMeanFloor, least_change_);
  const bool has_fringes = wanted_.fringes && scene_.has_tunnel;
  std::optional<FringeScores> fringes;
  ScanSums sums;
  ImageF grey;
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    const int index = static_cast<int>(k);
    const bool is_watched = flawless_ || consume || (k == 0 && has_fringes);
    accumulate_channels(sensor_,
                        channel_radiances(*picture_, frames_[k], without),
                        index,
                        sums,
                        is_watched ? &grey : nullptr);
    if (k == 0 && has_fringes) {
      fringes = fringe_scores(grey, traced_.region.mask, {.nominal_duty = scene_.tunnel.duty});
    }
    if (flawless_) {
      best.add(grey, flawless_->values(index, frames_[k], without));
    }
    if (consume) {
      consume(index, grey);
    }
  }
  Scored result = {.aspect = sums.aspect()};
  add_scores(
      result.scores,
      homogeneity(result.aspect, sums.clipped_frames, sums.frames, traced_.region, scene_.metrics));
  if (wanted_.family) {
    const FamilyScales scales = scales_of(scene_, traced_.defects, fringes);
    add_scores(result.scores,
               homogeneity_family(result.aspect, traced_.region.mask, scales, scene_.metrics));
  }
  if (fringes) {
    add_scores(result.scores, *fringes);
  }
  if (wanted_.defects) {
    result.defects = scored_defects(result.aspect, traced_.defects, best, scene_);
    add_scores(result.scores, result.defects);
  }
  return result;
}

/// "<score>.error" for each score that every set of batches has.
void add_errors(const PathScoring& scoring, ThreadPool& pool, Scores& scores) {
  const auto count = static_cast<std::int64_t>(scoring.batches());
  const auto without = pool.map<Scores>(count, [&](std::int64_t batch) {
    return scoring.score(static_cast<std::size_t>(batch)).scores;
  });
  Scores errors;
  for (const auto& [name, value] : scores) {
    std::vector<double> values;
    for (const Scores& one : without) {
      const auto found = one.find(name);
      if (found != one.end()) {
        values.push_back(found->second);
      }
    }
    if (values.size() == without.size()) {
      errors[error_name(name)] = jackknife_error(values);
    }
  }
  scores.merge(errors);
}

/// What the tunnel's wall does to the view.
void add_view_scores(const SceneSettings& scene,
                     const TracedScene& traced,
                     bool with_slot,
                     Scores& scores) {
  const Tunnel tunnel(scene.tunnel);
  const SeenPart& seen = traced.seen();
  if (with_slot) {
    scores["view.slot_margin_mm"] =
        slot_margin(seen, traced.region.mask, tunnel, traced.camera_in_world_mm).margin_mm;
  }
  scores["view.hidden_share"] =
      share_of_part(hidden_pixels(seen, tunnel, traced.camera_in_world_mm), seen);
}

}  // namespace

double jackknife_error(std::span<const double> without_one) {
  const auto count = static_cast<double>(without_one.size());
  double mean = 0.0;
  for (const double value : without_one) {
    mean += value / count;
  }
  double squares = 0.0;
  for (const double value : without_one) {
    squares += (value - mean) * (value - mean);
  }
  return std::sqrt((count - 1.0) / count * squares);
}

Evaluation evaluate_paths(SceneStore& store,
                          const SceneSettings& scene,
                          const FrameConsumer& consume,
                          const WantedScores& wanted) {
  check_scene(scene, wanted);
  if (scene.has_tunnel) {
    check_part_in_tunnel(*store.build(scene), Tunnel(scene.tunnel), scene.scan, scene.tunnel_name);
  }
  Evaluation result;
  result.traced = store.trace(scene);
  const PathScoring scoring(store, scene, wanted, *result.traced);
  Scored scored = scoring.score({}, consume);
  result.scores = std::move(scored.scores);
  if (wanted.errors && scoring.batches() > 1) {
    add_errors(scoring, store.pool(), result.scores);
  }
  add_scores(result.scores, totals_of(result.traced->part->made));
  if (scene.has_tunnel) {
    add_view_scores(scene, *result.traced, wanted.slot, result.scores);
  }
  result.form.frame_pixels = static_cast<int>(scored.aspect.size());
  result.aspect = std::move(scored.aspect);
  result.defects = std::move(scored.defects);
  return result;
}

}  // namespace glint
