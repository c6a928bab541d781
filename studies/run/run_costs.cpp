// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/run_costs.h"

#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "core/cpu_clock.h"
#include "core/image/image_io.h"
#include "core/wall_clock.h"
#include "studies/definition/render_methods.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;

/// Beyond this, work that takes as long once more is estimated instead of done.
constexpr double kLong_s = 5.0;

constexpr int kPage_px = 650;  ///< width of a frame on the report's page, about

/// Points spread evenly over the unit cube: the additive recurrence whose steps are powers of the
/// root of x^(d+1) = x + 1, which for d = 1 is the golden ratio.
///
/// Source: M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
std::vector<double> spread_point(std::size_t dimensions, int index) {
  double root = 2.0;
  for (int i = 0; i < 40; ++i) {
    root = std::pow(1.0 + root, 1.0 / (static_cast<double>(dimensions) + 1.0));
  }
  std::vector<double> point(dimensions);
  for (std::size_t i = 0; i < dimensions; ++i) {
    const double step = std::pow(root, -static_cast<double>(i + 1));
    const double sum = 0.5 + step * index;
    point[i] = sum - std::floor(sum);
  }
  return point;
}

/// CPU seconds of evaluating a point of the space; one that cannot be built costs what that takes.
double evaluation_s(const Study& study, SceneStore& store, const Point& point) {
  const double start = process_cpu_s();
  try {
    evaluate(store, scene_with(study, overrides_of(study, point)), {}, wanted_in_search(study));
  } catch (const ConfigError&) {
    return process_cpu_s() - start;
  }
  return process_cpu_s() - start;
}

}  // namespace

WantedScores wanted_in_search(const Study& study) {
  return needs_gradient(study.search.algorithm) ? wanted_with_gradients(study.goal, study.space)
                                                : wanted_by(study.goal);
}

double measure_evaluation_s(const Study& study,
                            SceneStore& store,
                            const std::function<void()>& step) {
  step();
  const auto start = Clock::now();
  const double first_s = evaluation_s(study, store, baseline_point(study));  // pays for cold caches
  double sum_s = 0.0;
  int count = 0;
  while (count + 1 < kSampledDesigns && (count < 2 || seconds_since(start) < 2.0 * kLong_s)) {
    step();
    const std::vector<double> unit = spread_point(study.space.variables.size(), ++count);
    sum_s += evaluation_s(study, store, point_from_unit(study.space, unit));
  }
  const double each_s = sum_s / count;
  const int evaluations = study.budget.evaluations;
  return evaluations > 1 ? (first_s + each_s * (evaluations - 1)) / evaluations : each_s;
}

RenderedDesign render_design(SceneStore& store,
                             const SceneSettings& wanted_scene,
                             const WantedScores& wanted) {
  const double start = process_cpu_s();
  const SceneSettings scene = first_view(store, wanted_scene);
  std::size_t bytes = 0;
  // Once for the sequence, once for the page.
  const auto encode = [&](int /*index*/, const ImageF& grey) {
    bytes += png_bytes(grey).size() + report_png(grey, kPage_px).size();
  };
  Evaluation evaluation = evaluate(store, scene, encode, wanted.with_whole_scan());
  bytes += png_bytes(evaluation.aspect).size();
  if (frame_method(scene).has_closed_mean) {
    evaluate(store, scene, {}, wanted.of_one_scan());  // set beside the whole scan in the report
  }
  return {.evaluation = std::move(evaluation), .cpu_s = process_cpu_s() - start};
}

double measure_rescoring_s(SceneStore& store,
                           const SceneSettings& wanted_scene,
                           const WantedScores& wanted,
                           double rendering_s) {
  constexpr double kTimesFiner = 4.0;
  if (rendering_s > kLong_s) {
    return kTimesFiner * rendering_s;
  }
  const double start = process_cpu_s();
  const SceneSettings scene = first_view(store, wanted_scene);
  try {
    evaluate(store, finer_settings(scene), {}, wanted.with_whole_scan(kFreshParts));
  } catch (const ConfigError&) {  // the finer picture may not fit into memory: left out
    return 0.0;
  }
  return process_cpu_s() - start;
}

double measure_scan_s(SceneStore& store, const SceneSettings& scene, const WantedScores& wanted) {
  const double start = process_cpu_s();
  try {
    evaluate(store, repeated_settings(first_view(store, scene), 0), {}, wanted);
  } catch (const ConfigError&) {  // a scan that cannot be made: left out
    return 0.0;
  }
  return process_cpu_s() - start;
}

}  // namespace glint
