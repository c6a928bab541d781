// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/inspector_frontier.h"

#include <algorithm>
#include <array>
#include <chrono>

#include <fmt/format.h>

#include "core/cpu_clock.h"
#include "studies/inspection_line/simulated_line.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;
using Filter = InspectionSettings::Filter;

constexpr std::array kSigmas = {3.0, 4.0, 5.0, 6.0, 8.0, 11.0, 15.0, 21.0, 30.0, 42.0, 60.0, 85.0};

std::string label_of(const InspectionSettings& settings) {
  switch (settings.filter) {
    case Filter::kGaussian:
      return fmt::format("gaussian {} px", settings.kernel_px);
    case Filter::kDifferenceOfGaussians:
      return fmt::format("difference of gaussians, scales {} px",
                         fmt::join(settings.scales_px, ", "));
    case Filter::kMatched:
      return fmt::format("matched {:g} px", settings.template_px);
    case Filter::kStructure:
      return fmt::format("structure {:g} px", settings.structure_px);
    case Filter::kPhase:
      break;
  }
  return "phase";
}

class InspectorList {
 public:
  explicit InspectorList(const InspectionSettings& own) : own_(own) {
    points_.push_back({.label = label_of(own), .settings = own, .is_current = true});
  }

  template <class Number>
  void add(Filter filter, Number InspectionSettings::*size, std::initializer_list<Number> sizes) {
    for (const Number& value : sizes) {
      InspectionSettings settings = own_;
      settings.filter = filter;
      settings.sigma_px = 0.0;
      settings.*size = value;
      const std::string label = label_of(settings);
      if (std::ranges::find(points_, label, &InspectorPoint::label) == points_.end()) {
        points_.push_back({.label = label, .settings = settings});
      }
    }
  }

  std::vector<InspectorPoint> points() { return std::move(points_); }

 private:
  InspectionSettings own_;
  std::vector<InspectorPoint> points_;
};

/// Reports at each threshold, of one scan or of many.
struct ReportCounts {
  std::vector<int> found;
  std::vector<int> false_reports;
  int defects = 0;

  explicit ReportCounts(std::size_t thresholds = 0)
      : found(thresholds), false_reports(thresholds) {}

  void add(const ReportCounts& other) {
    for (std::size_t i = 0; i < found.size(); ++i) {
      found[i] += other.found[i];
      false_reports[i] += other.false_reports[i];
    }
    defects += other.defects;
  }
};

ReportCounts counts_of(const SimulatedLine& line,
                       const ScannedPart& part,
                       const std::vector<double>& thresholds) {
  ReportCounts counts(thresholds.size());
  counts.defects = static_cast<int>(part.defects.size());
  for (std::size_t i = 0; i < thresholds.size(); ++i) {
    const auto matches = match_detections(
        line.inspect(part, thresholds[i]), part.defects, line.scene().inspection.trials);
    counts.found[i] = matches.found();
    counts.false_reports[i] = matches.false_alarms();
  }
  return counts;
}

class InspectorMeasuring {
 public:
  InspectorMeasuring(const SceneSettings& scene, const FrontierOptions& options)
      : scene_(scene), options_(options), pool_(options.threads), store_(pool_) {
    frontier_.points = compared_inspectors(scene.inspection);
    frontier_.allowed = scene.inspection.false_alarms_per_picture;
  }

  InspectorFrontier run() {
    choose_numbers();
    for (InspectorPoint& point : frontier_.points) {
      tell(point.label);
      measure_in_time(point);
      ++done_;
    }
    mark_inspectors(frontier_.allowed, frontier_.points);
    return std::move(frontier_);
  }

 private:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  void tell(const std::string& next) const {
    if (options_.on_progress) {
      options_.on_progress(
          static_cast<double>(done_) / static_cast<double>(frontier_.points.size()), next);
    }
  }

  /// As many parts as the scene asks for, or as the budget is enough for, by one of each.
  void choose_numbers() {
    constexpr double kShare = 0.8;
    constexpr int kMin = 2;
    tell("first scans");
    const SimulatedLine line(store_, scene_);
    const double start = seconds();
    line.part(0);
    line.flawless(0);
    const double rounds =
        kShare * options_.budget_s /
        (std::max(1e-6, seconds() - start) * static_cast<double>(frontier_.points.size()));
    const auto within = [&](int wanted) {
      return std::clamp(static_cast<int>(std::min(1e6, rounds)), kMin, wanted);
    };
    frontier_.parts = within(std::max(kMin, scene_.inspection.trials.parts));
    frontier_.flawless = within(scene_.inspection.trials.flawless);
  }

  void measure_in_time(InspectorPoint& point) {
    if (seconds() > options_.budget_s && !point.is_current) {
      point.problem = "left out: the budget of time was used up";
      return;
    }
    try {
      measure(point);
    } catch (const ConfigError& error) {
      point.problem = error.what();
    }
  }

  void measure(InspectorPoint& point) {
    SceneSettings scene = scene_;
    scene.inspection = point.settings;
    const SimulatedLine line(store_, scene);
    point.region_share = line.region_share();
    const ScannedPart first = line.flawless(0);
    const double noise = line.inspector().noise(first.response, pool_);
    std::vector<double> thresholds;
    for (const double sigmas : kSigmas) {
      thresholds.push_back(std::max(line.inspector().min_threshold(), sigmas * noise));
    }
    if (point.is_current) {
      thresholds.push_back(line.threshold());
    }
    point.curve = curve_of(line, thresholds, noise);
    if (point.is_current) {
      point.own = point.curve.back();
      point.curve.pop_back();
    }
    if (point.settings.filter != Filter::kPhase) {
      point.cpu_s = seconds_of(line, first, point.own ? point.own->threshold : thresholds[3]);
    }
  }

  std::vector<DetectionPoint> curve_of(const SimulatedLine& line,
                                       const std::vector<double>& thresholds,
                                       double noise) {
    const ReportCounts parts = count(thresholds.size(), frontier_.parts, [&](std::int64_t number) {
      return counts_of(line, line.part(number), thresholds);
    });
    const std::int64_t calibrating = scene_.inspection.trials.flawless;
    const ReportCounts flawless =
        count(thresholds.size(), frontier_.flawless, [&](std::int64_t number) {
          // The first ones may have set the threshold.
          return counts_of(line, line.flawless(calibrating + number), thresholds);
        });
    const double confidence = scene_.inspection.trials.confidence;
    std::vector<DetectionPoint> curve;
    for (std::size_t i = 0; i < thresholds.size(); ++i) {
      curve.push_back(
          {.threshold = thresholds[i],
           .sigmas = noise > 0.0 ? thresholds[i] / noise : 0.0,
           .detected = wilson(parts.found[i], std::max(1, parts.defects), confidence),
           .false_reports = poisson_rate(flawless.false_reports[i], frontier_.flawless, confidence),
           .reports = parts.false_reports[i]});
    }
    return curve;
  }

  template <class CountOne>
  ReportCounts count(std::size_t thresholds, int scans, const CountOne& count_one) {
    ReportCounts sum(thresholds);
    for (const ReportCounts& one : pool_.map<ReportCounts>(scans, count_one)) {
      sum.add(one);
    }
    return sum;
  }

  /// One picture from its mean image to the list.
  static double seconds_of(const SimulatedLine& line, const ScannedPart& part, double threshold) {
    constexpr int kRepeats = 3;
    constexpr double kTotal_s = 0.2;
    ThreadPool alone(1);
    return min_cpu_s(kRepeats, kTotal_s, [&] {
      line.inspector().blobs(line.inspector().response(part.aspect, alone), threshold, alone);
    });
  }

  Clock::time_point start_ = Clock::now();
  SceneSettings scene_;
  const FrontierOptions& options_;
  ThreadPool pool_;
  SceneStore store_;
  std::size_t done_ = 0;
  InspectorFrontier frontier_;
};

}  // namespace

std::vector<InspectorPoint> compared_inspectors(const InspectionSettings& own) {
  InspectorList list(own);
  list.add(Filter::kGaussian, &InspectionSettings::kernel_px, {5, 9, 15, 31, 63});
  list.add(Filter::kDifferenceOfGaussians,
           &InspectionSettings::scales_px,
           {std::vector{1.0}, std::vector{1.0, 2.0, 4.0}, std::vector{2.0, 4.0, 8.0}});
  list.add(Filter::kMatched, &InspectionSettings::template_px, {3.0, 5.0, 10.0, 20.0});
  list.add(Filter::kStructure, &InspectionSettings::structure_px, {8.0, 16.0, 32.0});
  return list.points();
}

void mark_inspectors(double allowed, std::vector<InspectorPoint>& points) {
  for (InspectorPoint& point : points) {
    point.best.reset();
    for (const DetectionPoint& one : point.curve) {
      const bool is_allowed = one.false_reports.value <= allowed;
      if (is_allowed && (!point.best || one.detected.value > point.best->detected.value)) {
        point.best = one;
      }
    }
  }
  for (InspectorPoint& point : points) {
    point.is_on_front =
        point.best && point.cpu_s && std::ranges::none_of(points, [&](const InspectorPoint& other) {
          return other.best && other.cpu_s && *other.cpu_s <= *point.cpu_s &&
                 (other.best->detected.value > point.best->detected.value ||
                  (other.best->detected.value == point.best->detected.value &&
                   *other.cpu_s < *point.cpu_s));
        });
  }
}

InspectorFrontier measure_inspectors(const SceneSettings& scene, const FrontierOptions& options) {
  if (scene.defects.empty()) {
    throw ConfigError("defects", "has no entry; an inspection is judged by the defects it finds");
  }
  return InspectorMeasuring(scene, options).run();
}

}  // namespace glint
