// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/run_costs.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "core/cpu_clock.h"
#include "core/image/image_io.h"
#include "studies/definition/ladder/counted_work.h"
#include "studies/definition/render_methods.h"
#include "studies/output/scratch_folder.h"
#include "studies/report/report.h"
#include "studies/run/repeated_scores.h"
#include "studies/run/search_clock.h"
#include "studies/run/search_race.h"
#include "studies/run/study_search.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

/// Beyond this, work that takes as long once more is estimated instead of done.
constexpr double kLong_s = 5.0;

constexpr int kPage_px = 650;  ///< width of a frame on the report's page, about

}  // namespace

std::optional<PredictedSearch> predicted_search(const Budget& budget,
                                                double evaluation_s,
                                                int at_once) {
  const double in_time_s = budget.wall_clock_s * at_once;
  const bool has_count = budget.evaluations > 0;
  const double all_s = evaluation_s * budget.evaluations;
  if (budget.wall_clock_s > 0.0 && (!has_count || in_time_s < all_s)) {
    constexpr double kMax = 1e9;
    const double count = evaluation_s > 0.0 ? std::min(kMax, in_time_s / evaluation_s) : 0.0;
    return PredictedSearch{
        .cpu_s = in_time_s, .evaluations = static_cast<int>(count), .is_timed = true};
  }
  return has_count
             ? std::optional(PredictedSearch{.cpu_s = all_s, .evaluations = budget.evaluations})
             : std::nullopt;
}

SearchSample sample_search(const Study& study,
                           SceneStore& store,
                           int jobs,
                           const std::function<void()>& step,
                           const std::optional<SearchRungs>& rungs) {
  const ScratchFolder scratch("the first designs of the search");
  Storage storage = Storage::open(scratch.path() / "study.sqlite", {.seed = study.search.seed});
  SearchTask task = search_task(study, jobs);
  const int planned = study.budget.evaluations > 0 ? study.budget.evaluations : kSampledDesigns;
  task.budget = {.evaluations = std::min(planned, kSampledDesigns)};
  SearchClock clock(std::min(jobs, study.search.batch));
  const double start = process_cpu_s();
  std::atomic<int> enough = 0;
  const auto look = [&](const SearchProgress& progress) {
    step();
    clock.note(progress.evaluations, process_cpu_s() - start);
    enough = clock.is_long() ? 1 : 0;
  };
  const auto evaluate_point = [&](const Point& point, int /*trial*/) {
    return evaluate_candidate(store, study, point, rungs ? &rungs->of(point) : nullptr);
  };
  const SearchResult result = run_search(task, storage, evaluate_point, &enough, look);
  SearchSample sample{.evaluation_s = clock.mean_s(planned)};
  if (result.best) {
    sample.best = result.best->point;
  }
  return sample;
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

namespace {

double finer_scan_s(SceneStore& store,
                    const SceneSettings& scene,
                    const WantedScores& wanted,
                    double rendering_s) {
  if (rendering_s > kLong_s) {
    return rescoring_factor(scene) * rendering_s;
  }
  const double start = process_cpu_s();
  try {
    evaluate(store, rescoring_settings(scene), {}, wanted.with_whole_scan(kFreshParts));
  } catch (const ConfigError&) {  // the finer picture may not fit into memory: left out
    return 0.0;
  }
  return process_cpu_s() - start;
}

/// Where the light meets the wall is kept from the second scan on: the third is like all further.
double repeated_scans_s(SceneStore& store, const SceneSettings& scene, const WantedScores& wanted) {
  constexpr int kMeasured = 3;
  double sum_s = 0.0;
  for (int k = 0; k < kMeasured; ++k) {
    const double start = process_cpu_s();
    try {
      repeated_scan(store, scene, wanted, k);
    } catch (const ConfigError&) {  // a scan that cannot be made: left out
      return 0.0;
    }
    const double scan_s = process_cpu_s() - start;
    const bool is_last = k + 1 == kMeasured || scan_s > 0.2 * kLong_s;
    sum_s += is_last ? (kRepeatedScans - k) * scan_s : scan_s;
    if (is_last) {
      break;
    }
  }
  return sum_s;
}

}  // namespace

double measure_rescoring_s(SceneStore& store,
                           const Study& study,
                           const SceneSettings& wanted_scene,
                           double rendering_s) {
  const SceneSettings scene = first_view(store, wanted_scene);
  const double finer_s = finer_scan_s(store, scene, wanted_by(study.goal), rendering_s);
  return finer_s +
         (study.has_objective ? repeated_scans_s(store, scene, wanted_of_repeats(study)) : 0.0);
}

double measure_race_s(SceneStore& store,
                      const Study& study,
                      const std::optional<Point>& best,
                      int replicates) {
  if (replicates == 0) {
    return 0.0;
  }
  const SceneSettings scene = best ? scene_with(study, overrides_of(study, *best)) : study.scene;
  const double start = process_cpu_s();
  try {
    replicate_scores(store, study, scene, 0);
  } catch (const ConfigError&) {  // such a design is out of the race
  }
  return replicates * (process_cpu_s() - start);
}

}  // namespace glint
