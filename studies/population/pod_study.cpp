// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/population/pod_study.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/csv.h"
#include "core/file.h"
#include "metrics/statistics/pod.h"
#include "studies/inspection_line/inspection_json.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kCurvePoints = 101;

/// Hits and misses of one size.
struct LevelCount {
  double size_mm = 0.0;
  std::int64_t defects = 0;
  std::int64_t hits = 0;
  std::int64_t masked = 0;  ///< where the line does not look
};

struct PodDesign {
  PopulationDesign design;
  double threshold = 0.0;
  double region_share = 0.0;
  std::vector<LevelCount> levels;
  std::int64_t flawless_scans = 0;
  std::int64_t flawless_blobs = 0;
};

int num_parts(const PodSettings& settings) {
  return settings.levels * settings.parts;
}

std::int64_t steps_of(const Study& study) {
  std::int64_t steps = 0;
  for (const PopulationDesign& design : population_designs(study)) {
    steps += num_parts(*study.pod) + flawless_of(*study.pod, design);
  }
  return steps;
}

enum class Places { kLookedAt, kAll };

/// Defects of a level at such places; at others none is found.
std::int64_t count_of(const LevelCount& level, Places places) {
  return level.defects - (places == Places::kLookedAt ? level.masked : 0);
}

/// Sizes in the unit of the table.
std::vector<SizedTrial> trials_of(const std::vector<LevelCount>& levels,
                                  double unit_mm,
                                  Places places) {
  std::vector<SizedTrial> trials;
  for (const LevelCount& level : levels) {
    const std::int64_t count = count_of(level, places);
    for (std::int64_t i = 0; i < count; ++i) {
      trials.push_back({.size = level.size_mm / unit_mm, .is_hit = i < level.hits});
    }
  }
  return trials;
}

/// null where the number is infinite.
Json finite_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json fit_json(const std::optional<PodFit>& fit) {
  if (!fit) {
    return nullptr;
  }
  return {{"a50", finite_json(fit->a50)},
          {"a90",
           {{"value", finite_json(fit->a90.value)},
            {"low", finite_json(fit->a90.low)},
            {"high", finite_json(fit->a90.high)}}},
          {"a90_95", finite_json(fit->a90_95)},
          {"intercept", fit->intercept},
          {"slope", fit->slope}};
}

Json levels_json(const PodDesign& pod, double unit_mm, double confidence) {
  Json levels = Json::array();
  for (const LevelCount& level : pod.levels) {
    Json json = {{"size", level.size_mm / unit_mm},
                 {"defects", level.defects},
                 {"hits", level.hits},
                 {"masked", level.masked}};
    const std::int64_t looked_at = count_of(level, Places::kLookedAt);
    json["share"] =
        looked_at > 0 ? estimate_json(wilson(level.hits, looked_at, confidence)) : Json(nullptr);
    levels.push_back(json);
  }
  return levels;
}

Json design_json(const PodDesign& pod, const PodSize& size, double confidence) {
  std::int64_t defects = 0;
  std::int64_t masked = 0;
  for (const LevelCount& level : pod.levels) {
    defects += level.defects;
    masked += level.masked;
  }
  return {{"title", pod.design.title},
          {"defects", defects},
          {"masked", masked},
          {"fit",
           fit_json(fit_pod(trials_of(pod.levels, size.unit_mm, Places::kLookedAt), confidence))},
          {"fit_all_places",
           fit_json(fit_pod(trials_of(pod.levels, size.unit_mm, Places::kAll), confidence))},
          {"false_alarms", false_alarms_json(pod.flawless_blobs, pod.flawless_scans, confidence)},
          {"threshold", pod.threshold},
          {"region_share", pod.region_share},
          {"levels", levels_json(pod, size.unit_mm, confidence)}};
}

std::string levels_csv(const std::vector<PodDesign>& designs, const PodSize& size) {
  std::string csv = csv_row_of("design", size.key, "defects", "hits", "masked");
  for (const PodDesign& pod : designs) {
    for (const LevelCount& level : pod.levels) {
      csv += csv_row_of(
          pod.design.key, level.size_mm / size.unit_mm, level.defects, level.hits, level.masked);
    }
  }
  return csv;
}

/// Points of a curve with its band, evenly by ratio over all sizes and a little beyond.
Json curve_json(const PodFit& fit,
                const std::vector<LevelCount>& levels,
                double unit_mm,
                double confidence) {
  const double smallest = 0.9 * levels.front().size_mm / unit_mm;
  const double largest = 1.1 * levels.back().size_mm / unit_mm;
  Json points = Json::array();
  for (int i = 0; i < kCurvePoints; ++i) {
    const double size = smallest * std::pow(largest / smallest, i / (kCurvePoints - 1.0));
    Json point = estimate_json(fit.at(size, confidence));
    point["size"] = size;
    points.push_back(point);
  }
  return points;
}

/// The curve of each design that has one: what the report's chart shows beside result.json.
Json curves_json(const std::vector<PodDesign>& designs, double unit_mm, double confidence) {
  Json curves = Json::object();
  for (const PodDesign& pod : designs) {
    if (const auto fit = fit_pod(trials_of(pod.levels, unit_mm, Places::kLookedAt), confidence)) {
      curves[pod.design.key] = curve_json(*fit, pod.levels, unit_mm, confidence);
    }
  }
  return curves;
}

class PodRun {
 public:
  explicit PodRun(const PopulationTask& task)
      : task_(task),
        settings_(*task.study.pod),
        records_(task.storage),
        progress_(task, steps_of(task.study)) {}

  std::optional<Json> execute() {
    for (const PopulationDesign& design : population_designs(task_.study)) {
      std::optional<PodDesign> pod = measure(design);
      if (!pod) {
        return std::nullopt;
      }
      designs_.push_back(std::move(*pod));
    }
    return write();
  }

 private:
  std::optional<PodDesign> measure(const PopulationDesign& design) {
    const std::string name = "pod/" + design.key;
    const std::unique_ptr<SimulatedLine> line = line_of(task_, design);
    PodDesign pod = {.design = design, .levels = {}};
    pod.threshold = recorded_threshold(records_, *line, name + "/threshold");
    pod.region_share = line->region_share();
    const auto parts = record_all(
        task_, records_, progress_, name + "/part", num_parts(settings_), [&](std::int64_t number) {
          return inspect_sized_part(*line, settings_, pod.threshold, number);
        });
    if (!parts) {
      return std::nullopt;
    }
    count_levels(*parts, pod);
    const auto flawless = record_all(
        task_,
        records_,
        progress_,
        name + "/flawless",
        flawless_of(settings_, design),
        [&](std::int64_t number) { return inspect_flawless(*line, pod.threshold, number); });
    if (!flawless) {
      return std::nullopt;
    }
    pod.flawless_scans = static_cast<std::int64_t>(flawless->size());
    for (const Scores& scan : *flawless) {
      pod.flawless_blobs += static_cast<std::int64_t>(scan.at("blobs"));
    }
    return pod;
  }

  void count_levels(const std::vector<Scores>& parts, PodDesign& pod) const {
    for (const double size_mm : level_sizes_mm(settings_)) {
      pod.levels.push_back({.size_mm = size_mm});
    }
    const auto each = static_cast<std::size_t>(settings_.parts);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      LevelCount& level = pod.levels[i / each];
      level.defects += static_cast<std::int64_t>(parts[i].at("defects"));
      level.hits += static_cast<std::int64_t>(parts[i].at("hits"));
      level.masked += static_cast<std::int64_t>(parts[i].at("masked"));
    }
  }

  Json write() const {
    const PodSize size = size_of(settings_);
    const double confidence = task_.study.scene.inspection.trials.confidence;
    Json designs = Json::object();
    for (const PodDesign& pod : designs_) {
      designs[pod.design.key] = design_json(pod, size, confidence);
    }
    write_file(task_.out / "pod.csv", levels_csv(designs_, size));
    write_file(task_.out / "pod_curves.json",
               curves_json(designs_, size.unit_mm, confidence).dump() + "\n");
    return {{"group", settings_.group},
            {"size", size.key},
            {"unit", size.unit},
            {"confidence", confidence},
            {"designs", designs}};
  }

  const PopulationTask& task_;
  const PodSettings& settings_;
  PartRecords records_;
  PopulationProgress progress_;
  std::vector<PodDesign> designs_;
};

}  // namespace

std::vector<NamedGroup> group_of_size(const PodSettings& settings,
                                      const std::vector<NamedGroup>& defects,
                                      double size_mm) {
  const auto found = std::ranges::find(
      defects, settings.group, [](const NamedGroup& group) { return group.first; });
  GLINT_CHECK(found != defects.end(), "the group was checked when the study was read");
  NamedGroup group = *found;
  group.second.*(size_of(settings).member) = size_mm;
  return {group};
}

Scores inspect_sized_part(const SimulatedLine& line,
                          const PodSettings& settings,
                          double threshold,
                          std::int64_t number) {
  const std::vector<double> sizes_mm = level_sizes_mm(settings);
  const double size_mm = sizes_mm[static_cast<std::size_t>(number / settings.parts)];
  const ScannedPart part =
      line.part_with(group_of_size(settings, line.scene().defects, size_mm), number);
  const DetectionMatches matches =
      match_detections(line.inspect(part, threshold), part.defects, line.scene().inspection.trials);
  const auto masked = std::ranges::count_if(
      part.defects, [](const TrueDefect& defect) { return defect.is_masked; });
  return {{"defects", static_cast<double>(part.defects.size())},
          {"hits", matches.found()},
          {"masked", static_cast<double>(masked)},
          {"false_alarms", matches.false_alarms()}};
}

std::optional<Json> run_pod(const PopulationTask& task) {
  return PodRun(task).execute();
}

double predicted_pod_s(const Study& study, SceneStore& store) {
  const PodSettings& settings = *study.pod;
  const SimulatedLine line(store, study.scene);
  const double threshold = study.scene.inspection.threshold_grey;
  const std::int64_t stride = spread_stride(num_parts(settings));
  const PopulationPace pace = measure_pace(line, store.pool(), [&](std::int64_t number) {
    inspect_sized_part(line, settings, threshold, number * stride % num_parts(settings));
  });
  const std::int64_t for_threshold = num_threshold_scans(study.scene.inspection);
  double seconds = 0.0;
  for (const PopulationDesign& design : population_designs(study)) {
    const std::int64_t flawless = for_threshold + flawless_of(settings, design);
    seconds += pace.part_s * num_parts(settings) + pace.flawless_s * static_cast<double>(flawless);
  }
  return seconds;
}

}  // namespace glint
