// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <unistd.h>

#include "core/cpu_clock.h"
#include "core/wall_clock.h"
#include "studies/evaluation/evaluation.h"
#include "studies/frontier/banded_scan.h"
#include "studies/frontier/frontier_errors.h"
#include "studies/frontier/frontier_methods.h"
#include "studies/frontier/path_frontier.h"

namespace glint {
namespace {

constexpr double kMinContrast = 0.01;  ///< smaller ones are not worth a relative error
constexpr double kTimedTotal_s = 0.3;

constexpr const char* kBudgetProblem = "left out: the budget of time was used up";

/// More rays at once are rendered in bands: 36 bytes each.
constexpr std::int64_t kMaxRays = std::int64_t{1} << 25;

/// A sensor whose grey values are radiances times the gain.
SceneSettings linear(SceneSettings scene, double gain) {
  scene.sensor = {.exposure = 1.0, .gain = gain, .blur_px = 0.0, .bits = 0};
  return scene;
}

/// Root of the mean square of what is added.
class Rmse {
 public:
  void add(double error) {
    sum_ += error * error;
    ++count_;
  }

  double value() const { return std::sqrt(sum_ / std::max(1.0, static_cast<double>(count_))); }

 private:
  double sum_ = 0.0;
  std::int64_t count_ = 0;
};

/// The frames all others are compared with.
struct ReferenceFrames {
  BandedScan scan;
  Mask smooth;  ///< pixels without edge of the light, rim of the part, defect
};

/// Compares frames with the reference on all pixels that see the part, in order.
class FrameErrors {
 public:
  FrameErrors(const ReferenceFrames& reference, double gain) : reference_(reference), gain_(gain) {}

  void add(int index, const ImageF& grey) {
    const ImageF& right = reference_.scan.radiance[static_cast<std::size_t>(index)];
    const bool is_same = grey.width() == right.width() && grey.height() == right.height();
    const ImageF full = is_same ? ImageF() : enlarged(grey, right.width(), right.height());
    const ImageF::Values& values = (is_same ? grey : full).values();
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (reference_.scan.seen.coverage.values()[i] > 0.0F) {
        const double error =
            static_cast<double>(values[i]) / gain_ - static_cast<double>(right.values()[i]);
        all_.add(error);
        if (reference_.smooth.values()[i] != 0) {
          smooth_.add(error);
        }
      }
    }
  }

  void store(FrontierPoint& point) const {
    point.frame_rmse = all_.value();
    point.smooth_frame_rmse = smooth_.value();
  }

 private:
  const ReferenceFrames& reference_;
  double gain_;
  Rmse all_;
  Rmse smooth_;
};

double relative_percent(double value, double right) {
  return 100.0 * std::abs(value - right) / std::max(std::abs(right), kMinContrast);
}

/// The frames of the reference are kept; a scan of thousands of large ones does not fit.
void check_memory(const SceneSettings& scene) {
  const double needed = 4.0 * scene.camera.width_px * scene.camera.height_px * scene.scan.positions;
  const double available =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  if (needed > 0.25 * available) {
    throw ConfigError(
        "scan.positions",
        fmt::format("{} pictures of {} x {} px need {:.1f} GB to be compared with, this "
                    "machine has {:.1f} GB; allowed is a quarter of it",
                    scene.scan.positions,
                    scene.camera.width_px,
                    scene.camera.height_px,
                    needed * 1e-9,
                    available * 1e-9));
  }
}

/// Measures one method after the other.
class Measuring {
 public:
  Measuring(const SceneSettings& scene, const FrontierOptions& options)
      : scene_(noiseless(scene)), options_(options), pool_(options.threads) {
    frontier_.points = frontier_methods(scene_);
    for (const FrontierPoint& point : frontier_.points) {
      total_work_ += work_of(point);
    }
  }

  Frontier run() {
    measure_reference();
    for (FrontierPoint& point : frontier_.points) {
      if (!point.is_reference) {
        report(point.label);
        measure_in_time(point);
        done_work_ += work_of(point);
      }
    }
    estimate_own_error();
    mark_front(frontier_.points);
    return std::move(frontier_);
  }

 private:
  /// Rays are what takes time, roughly.
  double work_of(const FrontierPoint& point) const {
    const double pixels = 1.0 / (point.reduction * point.reduction);
    const int rays_per_px = point.method.rays_per_px;
    return pixels * (16.0 + (rays_per_px > 0 ? rays_per_px : 16));
  }

  void report(const std::string& next, double more = 0.0) const {
    if (options_.on_progress) {
      options_.on_progress(std::min(1.0, (done_work_ + more) / total_work_), next);
    }
  }

  void measure_reference() {
    const auto at = std::ranges::find_if(
        frontier_.points, [](const FrontierPoint& point) { return point.is_reference; });
    FrontierPoint& point = *at;
    const SceneSettings scene = scene_of(point, scene_);
    const double work = work_of(point);
    const int height_px = scene.camera.height_px;
    const auto on_band = [&](int rows) { report("reference", work * rows / height_px); };
    on_band(0);
    SceneStore store(pool_);
    const double start = process_cpu_s();
    const SceneSettings plain = scene_of(frontier_.points.front(), scene_);
    const auto traced = store.trace(plain);
    const double build_s = process_cpu_s() - start;
    ScoredScan scored =
        evaluate_in_bands(*traced->part, scene, pool_, {.repeats = 2, .on_band = on_band});
    point.cpu_s = scored.cpu_s;
    point.cold_s = build_s + scored.cold_cpu_s;
    set_plain_form(point, scene);
    point.frame_rmse = point.smooth_frame_rmse = 0.0;
    FrontierReference& reference = frontier_.reference;
    reference.method = point.method;
    reference.h_rms = scored.h_rms;
    keep_scores(scored.scores);
    for (const DefectScores& defect : scored.defects) {
      reference.weber[defect.label] = defect.weber;
      reference.change[defect.label] = defect.change;
      point.defects[defect.label] = {};
    }
    frames_ = {.scan = std::move(scored.scan), .smooth = std::move(scored.region)};
    for (std::size_t i = 0; i < frames_.smooth.size(); ++i) {
      frames_.smooth.values()[i] &= frames_.scan.lit.values()[i];
    }
    float largest = 1.0F;
    for (const ImageF& frame : frames_.scan.radiance) {
      largest = std::max(largest, *std::ranges::max_element(frame.values()));
    }
    gain_ = largest > 1.0F ? 0.99 / static_cast<double>(largest) : 1.0;
    done_work_ += work;
  }

  void measure_in_time(FrontierPoint& point) {
    // The scene's own setting and the program's are what the chart is about.
    const bool is_always_measured = point.method.is_current || point.method.is_choice;
    if (seconds_since(start_) > options_.budget_s && !is_always_measured) {
      point.problem = kBudgetProblem;
      return;
    }
    try {
      measure(point);
    } catch (const ConfigError& error) {
      point.problem = error.what();
    }
  }

  /// The one function that knows how a method is run.
  void measure(FrontierPoint& point) {
    const SceneSettings scene = scene_of(point, scene_);
    const auto rays =
        std::int64_t{scene.camera.width_px} * scene.camera.height_px * point.method.rays_per_px;
    if (rays > kMaxRays) {
      measure_in_bands(point, scene);
    } else {
      measure_at_once(point, scene);
    }
  }

  void measure_in_bands(FrontierPoint& point, const SceneSettings& scene) {
    SceneStore store(pool_);
    SceneSettings one_ray = scene;
    one_ray.render.rays_per_axis = 1;
    const auto traced = store.trace(one_ray);
    const ScoredScan scored =
        evaluate_in_bands(*traced->part, scene, pool_, {.repeats = options_.repeats});
    point.cpu_s = scored.cpu_s;
    point.cold_s = scored.cold_cpu_s;
    set_plain_form(point, scene);
    FrameErrors errors(frames_, 1.0);
    for (std::size_t i = 0; i < scored.scan.radiance.size(); ++i) {
      errors.add(static_cast<int>(i), scored.scan.radiance[i]);
    }
    errors.store(point);
    set_score_errors(point, scored.h_rms, scored.defects);
    set_errors_of_all(point, scored.scores);
  }

  static void set_plain_form(FrontierPoint& point, const SceneSettings& scene) {
    point.traced_per_px = point.method.rays_per_px;
    point.form = form_name(ScanForm::Kind::kFrames);
    point.frame_pixels = scene.camera.width_px * scene.camera.height_px;
  }

  void measure_at_once(FrontierPoint& point, const SceneSettings& scene) {
    ThreadPool alone(1);
    SceneStore store(alone);
    const double start = process_cpu_s();
    const FrameConsumer look = [](int /*index*/, const ImageF& /*grey*/) {};
    const FrameConsumer consume = point.method.has_frames ? look : FrameConsumer();
    const WantedScores wanted = {.fringes = false};  // they ask for a whole frame
    const Evaluation evaluation = evaluate(store, scene, consume, wanted);
    point.cold_s = process_cpu_s() - start;
    point.cpu_s = min_cpu_s(
        options_.repeats, kTimedTotal_s, [&] { evaluate(store, scene, consume, wanted); });
    point.traced_per_px = static_cast<double>(evaluation.traced->counts().camera) /
                          (static_cast<double>(scene.camera.width_px) * scene.camera.height_px);
    point.form = form_name(evaluation.form.kind);
    point.frame_pixels = evaluation.form.frame_pixels;
    set_score_errors(point, evaluation.scores.at("homogeneity.h_rms"), evaluation.defects);
    set_errors_of_all(point, evaluation.scores);
    if (point.method.has_frames) {
      FrameErrors errors(frames_, gain_);
      evaluate(store, linear(scene, gain_), [&](int index, const ImageF& grey) {
        errors.add(index, grey);
      });
      errors.store(point);
    }
  }

  void set_score_errors(FrontierPoint& point,
                        double h_rms,
                        const std::vector<DefectScores>& defects) const {
    point.h_error_points = 100.0 * std::abs(h_rms - frontier_.reference.h_rms);
    for (const DefectScores& defect : defects) {
      point.defects[defect.label] = {
          .weber_percent =
              relative_percent(defect.weber, frontier_.reference.weber.at(defect.label)),
          .change_percent =
              relative_percent(defect.change, frontier_.reference.change.at(defect.label))};
    }
  }

  /// Of the reference; which frames show a defect in parts is not put together in bands.
  void keep_scores(const Scores& scores) {
    for (const auto& [name, value] : scores) {
      if (std::isfinite(value) && !name.ends_with("union")) {
        frontier_.reference.scores[name] = {.value = value};
      }
    }
  }

  void set_errors_of_all(FrontierPoint& point, const Scores& scores) const {
    for (const auto& [name, right] : frontier_.reference.scores) {
      const auto found = scores.find(name);
      if (found != scores.end() && std::isfinite(found->second)) {
        point.scores[name] = {.value = found->second,
                              .error = std::abs(found->second - right.value)};
      }
    }
  }

  void estimate_own_error() {
    std::map<int, double> rmse;
    for (const FrontierPoint& point : frontier_.points) {
      if (is_like_reference(point, frontier_) && point.frame_rmse) {
        rmse[point.method.rays_per_px] = *point.frame_rmse;
      }
    }
    frontier_.reference.own_frame_rmse = glint::own_frame_rmse(rmse[16], rmse[64]);
  }

  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  SceneSettings scene_;
  const FrontierOptions& options_;
  ThreadPool pool_;
  ReferenceFrames frames_;
  double gain_ = 1.0;  ///< brings the brightest radiance to full scale
  double total_work_ = 0.0;
  double done_work_ = 0.0;
  Frontier frontier_;
};

}  // namespace

bool is_like_reference(const FrontierPoint& point, const Frontier& frontier) {
  return point.method.kind == frontier.reference.method.kind && point.reduction == 1 &&
         point.tessellation == frontier.points.front().tessellation;
}

Frontier measure_frontier(const SceneSettings& scene, const FrontierOptions& options) {
  if (!has_noiseless_reference(scene)) {
    return measure_path_frontier(scene, options);
  }
  Measuring measuring(scene, options);
  check_memory(scene);
  Frontier frontier = measuring.run();
  frontier.width_px = scene.camera.width_px;
  frontier.height_px = scene.camera.height_px;
  return frontier;
}

}  // namespace glint
