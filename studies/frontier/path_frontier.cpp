// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/path_frontier.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "core/cpu_clock.h"
#include "studies/definition/ladder/larger_pixels.h"
#include "studies/definition/ladder/render_ladder.h"
#include "studies/definition/render_methods.h"
#include "studies/evaluation/evaluation.h"
#include "studies/frontier/frontier_methods.h"
#include "studies/frontier/picture_errors.h"
#include "studies/frontier/pooled_score.h"
#include "studies/imaging/scene_picture.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kReferencePictures = 4;
constexpr int kTimedSamples = 16;              ///< of the picture whose time is taken
constexpr int kMaxPictures = 4;                ///< of a method
constexpr double kReferenceShare = 0.4;        ///< of the budget, at most
constexpr double kPicturesShare = 0.01;        ///< of the budget, for a method's further pictures
constexpr double kMinRelevantContrast = 0.01;  ///< smaller ones are not worth a relative error

/// What is scored: as in a search, and the defects.
WantedScores wanted_of(const Goal* goal) {
  WantedScores wanted = goal != nullptr ? wanted_by(*goal) : WantedScores{.slot = false};
  wanted.fringes = false;
  wanted.defects = wanted.picture = true;
  wanted.trials.clear();
  return wanted;
}

std::string weber_name(const std::string& label) {
  return "defects." + label + ".weber";
}

std::string change_name(const std::string& label) {
  return "defects." + label + ".change";
}

/// All scores of an evaluation that are figures of the picture.
Scores figures_of(const Evaluation& evaluation) {
  Scores figures;
  for (const auto& [name, value] : evaluation.scores) {
    if (std::isfinite(value) && !name.ends_with(".error")) {
      figures[name] = value;
    }
  }
  return figures;
}

/// Those that every picture without a batch has too, without noise.
std::map<std::string, ReferenceScore> pooled_scores(const Evaluation& evaluation) {
  std::map<std::string, ReferenceScore> pooled;
  for (const auto& [name, value] : figures_of(evaluation)) {
    std::vector<double> values;
    for (const Scores& without : evaluation.without_batch) {
      const auto found = without.find(name);
      if (found != without.end() && std::isfinite(found->second)) {
        values.push_back(found->second);
      }
    }
    if (values.size() == evaluation.without_batch.size()) {
      pooled[name] = pooled_score(name, value, values);
    }
  }
  return pooled;
}

/// Twice as many reflections as the scene's, and at least 8: what the scene leaves out is an error.
int reference_reflections(int own) {
  constexpr int kMax = 64;
  return std::min(kMax, std::max(8, 2 * own));
}

/// The scene whose one picture is all samples of the reference: twice its reflections, and batches
/// that share nothing. No pixel stops early, as the batches must weigh the same.
SceneSettings pooled_scene(SceneSettings scene, int samples) {
  scene.paths.max_reflections = reference_reflections(scene.paths.max_reflections);
  scene.paths.relative_error = 0.0;
  scene.paths.batches = kReferencePictures;
  return independent_paths(scene, kReferencePictures * samples, 0);
}

class PathMeasuring {
 public:
  PathMeasuring(const SceneSettings& scene, const FrontierOptions& options)
      : options_(options), pool_(options.threads), wanted_(wanted_of(options.goal)) {
    frontier_.pixel_factor = pixel_factor(scene.camera, kMaxFrontierPixels);
    scene_ = with_larger_pixels(scene, frontier_.pixel_factor);
    frontier_.width_px = scene_.camera.width_px;
    frontier_.height_px = scene_.camera.height_px;
    frontier_.points = frontier_methods(scene_);
  }

  Frontier run() {
    tell("first pictures");
    measure_speed();
    measure_reference();
    for (FrontierPoint* point : by_cost()) {
      tell(point->label);
      measure_in_time(*point);
    }
    mark_front(frontier_.points);
    return std::move(frontier_);
  }

 private:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  void tell(const std::string& next) const {
    if (options_.on_progress) {
      options_.on_progress(std::min(0.99, seconds() / options_.budget_s), next);
    }
  }

  /// Wall clock of a picture, by two of them.
  void measure_speed() {
    constexpr int kFew = 4;
    SceneStore store(pool_);
    store.leave_out_unseen_defects();
    scene_ = first_view(store, scene_);
    frontier_.unseen = store.trace(scene_)->unseen;
    const auto time_of = [&](int samples) {
      const double start = seconds();
      evaluate(store, independent_paths(scene_, samples, 0), {}, wanted_);
      return seconds() - start;
    };
    const double few = time_of(kFew);
    const double more = time_of(kTimedSamples);
    per_sample_s_ = std::max(1e-7, (more - few) / (kTimedSamples - kFew));
    fixed_s_ = std::max(0.0, few - kFew * per_sample_s_);
  }

  double predicted_s(const FrontierPoint& point) const {
    const double pixels = 1.0 / (point.reduction * point.reduction);
    const SceneSettings scene = scene_of(point, scene_);
    if (!frame_method(scene).is_noisy) {  // by work beside that of the paths whose time was taken
      const SceneSettings paths = independent_paths(scene_, kTimedSamples, 0);
      return pixels * fixed_s_ +
             per_sample_s_ * kTimedSamples * counted_work(scene) / counted_work(paths);
    }
    return pixels * (fixed_s_ + per_sample_s_ * point.method.paths.samples);
  }

  int reference_samples() const {
    constexpr int kMin = 16;
    constexpr int kMax = 1024;
    int samples = kMin;
    while (samples < kMax && kReferencePictures * (fixed_s_ + 4 * samples * per_sample_s_) <
                                 kReferenceShare * options_.budget_s) {
      samples *= 4;
    }
    return samples;
  }

  void measure_reference() {
    SceneStore store(pool_);
    store.leave_out_unseen_defects();
    const int samples = reference_samples();
    const SceneSettings scene = pooled_scene(scene_, samples);
    tell(fmt::format("reference, {} samples", scene.paths.samples));
    const Evaluation evaluation = evaluate(store, scene, {}, wanted_);
    scores_ = pooled_scores(evaluation);
    FrontierReference& reference = frontier_.reference;
    for (const DefectScores& defect : evaluation.defects) {
      const auto weber = scores_.find(weber_name(defect.label));
      const auto change = scores_.find(change_name(defect.label));
      if (weber != scores_.end() && change != scores_.end()) {
        reference.weber[defect.label] = weber->second.value;
        reference.change[defect.label] = change->second.value;
      }
    }
    const std::vector<ImageF> whole = frames_of(store, scene);
    for (std::size_t b = 0; b < std::size_t{kReferencePictures}; ++b) {
      const std::vector<ImageF> without = frames_of(store, scene, b);
      pictures_.add(*evaluation.traced, frames_of_batch(whole, without, kReferencePictures));
    }
    keep_reference(scene, samples);
  }

  void keep_reference(const SceneSettings& scene, int samples) {
    FrontierReference& reference = frontier_.reference;
    reference.pictures = kReferencePictures;
    reference.method = frontier_.points.front().method;
    reference.method.paths = scene.paths;
    reference.method.paths.samples = samples;
    reference.method.label = fmt::format("{} x {} samples", kReferencePictures, samples);
    reference.own_frame_rmse = pictures_.own_rmse();
    reference.h_rms = scores_.at("homogeneity.h_rms").value;
    reference.scores = scores_;
  }

  static std::vector<ImageF> frames_of(SceneStore& store,
                                       const SceneSettings& scene,
                                       std::optional<std::size_t> without = {}) {
    std::vector<ImageF> frames;
    const auto keep = [&](int /*index*/, const ImageF& grey) { frames.push_back(grey); };
    picture_of(store, noiseless(scene), {})
        ->mean({.watch = keep, .has_whole_frames = true, .without = without});
    return frames;
  }

  /// The scene's own setting before all others: a frontier without it tells little.
  std::vector<FrontierPoint*> by_cost() {
    std::vector<FrontierPoint*> points;
    for (FrontierPoint& point : frontier_.points) {
      points.push_back(&point);
    }
    std::ranges::stable_sort(points, {}, [&](const FrontierPoint* point) {
      return point->method.is_current ? 0.0 : predicted_s(*point);
    });
    return points;
  }

  void measure_in_time(FrontierPoint& point) {
    const double left_s = options_.budget_s - seconds();
    const double needed_s = predicted_s(point);
    if (needed_s > left_s && !point.method.is_current) {
      point.problem = fmt::format(
          "left out: one picture takes about {:.0f} s, and {:.0f} s of the budget are left",
          needed_s,
          std::max(0.0, left_s));
      return;
    }
    try {
      measure(point, needed_s);
    } catch (const ConfigError& error) {
      point.problem = error.what();
    }
  }

  void measure(FrontierPoint& point, double needed_s) {
    SceneStore store(pool_);
    store.leave_out_unseen_defects();
    const SceneSettings scene = scene_of(point, scene_);
    double start = process_cpu_s();
    store.trace(scene);
    const double build_s = process_cpu_s() - start;
    const bool has_noise = point.method.is_noisy;
    const double affordable = kPicturesShare * options_.budget_s / needed_s;
    point.pictures = has_noise ? std::clamp(static_cast<int>(affordable), 1, kMaxPictures) : 1;
    std::map<std::string, std::vector<double>> values;
    double mean_square = 0.0;
    double smooth_square = 0.0;
    for (int k = 0; k < point.pictures; ++k) {
      const SceneSettings one =
          has_noise ? independent_paths(scene, scene.paths.samples, kReferencePictures + k) : scene;
      start = process_cpu_s();
      const Evaluation evaluation = evaluate(store, one, {}, wanted_);
      const double taken_s = process_cpu_s() - start;
      point.cpu_s = k == 0 ? taken_s : std::min(point.cpu_s, taken_s);
      point.cold_s = k == 0 ? build_s + taken_s : point.cold_s;
      for (const auto& [name, value] : figures_of(evaluation)) {
        values[name].push_back(value);
      }
      const PictureDistance distance = pictures_.distance(frames_of(store, one), point.reduction);
      mean_square += distance.mean_square / point.pictures;
      smooth_square += distance.smooth_square / point.pictures;
      if (k == 0) {
        set_work(store, one, evaluation, point);
      }
    }
    point.frame_rmse = rms_less_noise(mean_square, pictures_.own_square());
    point.smooth_frame_rmse = rms_less_noise(smooth_square, pictures_.own_smooth_square());
    set_errors(values, point);
  }

  static void set_work(SceneStore& store,
                       const SceneSettings& scene,
                       const Evaluation& evaluation,
                       FrontierPoint& point) {
    const double pixels = static_cast<double>(scene.camera.width_px) * scene.camera.height_px;
    if (point.method.has_film) {
      const PathCounts counts = store.picture(scene)->sums.counts;
      point.rays = counts.camera + counts.shadow + counts.bounce;
      point.traced_per_px = static_cast<double>(counts.camera) / pixels;
    } else {
      point.traced_per_px = static_cast<double>(store.trace(scene)->counts().camera) / pixels;
    }
    point.form = form_name(evaluation.form.kind);
    point.frame_pixels = evaluation.form.frame_pixels;
  }

  void set_errors(const std::map<std::string, std::vector<double>>& values, FrontierPoint& point) {
    std::map<std::string, ScoreError> errors;
    for (const auto& [name, right] : scores_) {
      const auto found = values.find(name);
      if (found != values.end() && !found->second.empty()) {
        errors[name] = score_error(found->second, right);
      }
    }
    const auto found = errors.find("homogeneity.h_rms");
    point.h_error_points = found == errors.end() ? 0.0 : 100.0 * found->second.error;
    for (const auto& [label, weber] : frontier_.reference.weber) {
      const auto of_weber = errors.find(weber_name(label));
      const auto of_change = errors.find(change_name(label));
      if (of_weber != errors.end() && of_change != errors.end()) {
        const double change = frontier_.reference.change.at(label);
        point.defects[label] = {.weber_percent = 100.0 * of_weber->second.error /
                                                 std::max(kMinRelevantContrast, std::abs(weber)),
                                .change_percent = 100.0 * of_change->second.error /
                                                  std::max(kMinRelevantContrast, std::abs(change))};
      }
    }
    for (const auto& [name, score] : frontier_.reference.scores) {
      if (const auto error = errors.find(name); error != errors.end()) {
        point.scores[name] = error->second;
      }
    }
  }

  Clock::time_point start_ = Clock::now();
  const FrontierOptions& options_;
  ThreadPool pool_;
  WantedScores wanted_;
  SceneSettings scene_;
  double fixed_s_ = 0.0;  ///< of a picture, wall clock
  double per_sample_s_ = 0.0;
  ReferencePictures pictures_;
  std::map<std::string, ReferenceScore> scores_;  ///< of the reference
  Frontier frontier_;
};

}  // namespace

Frontier measure_path_frontier(const SceneSettings& scene, const FrontierOptions& options) {
  return PathMeasuring(scene, options).run();
}

}  // namespace glint
