// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/inspector_page.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studies/definition/study_text.h"
#include "studies/frontier/frontier_folder.h"
#include "studies/inspection_line/inspection_json.h"
#include "studies/output/output_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

Json detection_json(const std::optional<DetectionPoint>& point) {
  if (!point) {
    return nullptr;
  }
  return {{"threshold", point->threshold},
          {"sigmas", point->sigmas},
          {"detected", estimate_json(point->detected)},
          {"false_reports", estimate_json(point->false_reports)},
          {"reports_on_parts", point->reports}};
}

Json point_json(const InspectorPoint& point) {
  Json json = {{"label", point.label}, {"is_current", point.is_current}};
  if (!point.problem.empty()) {
    json["problem"] = point.problem;
    return json;
  }
  json["region_share"] = point.region_share;
  json["cpu_s"] = point.cpu_s ? Json(*point.cpu_s) : Json(nullptr);
  json["curve"] = Json::array();
  for (const DetectionPoint& one : point.curve) {
    json["curve"].push_back(detection_json(one));
  }
  json["own"] = detection_json(point.own);
  json["best"] = detection_json(point.best);
  json["on_front"] = point.is_on_front;
  return json;
}

std::string share_text(const DetectionPoint& point) {
  return fmt::format("{:.0f} % of the defects with {:.2g} false reports a picture",
                     100.0 * point.detected.value,
                     point.false_reports.value);
}

std::string sentence_of(const InspectorFrontier& frontier) {
  const InspectorPoint* best = nullptr;
  for (const InspectorPoint& point : frontier.points) {
    if (point.best &&
        (best == nullptr || point.best->detected.value > best->best->detected.value)) {
      best = &point;
    }
  }
  const InspectorPoint& own = frontier.points.front();
  std::string text =
      own.own ? fmt::format(
                    "The scene's own inspection ({}) finds {}.", own.label, share_text(*own.own))
              : "The scene's own inspection could not be measured.";
  if (best == nullptr) {
    return text + fmt::format(" No threshold of any filter keeps to {:g} false reports a picture.",
                              frontier.allowed);
  }
  return text + fmt::format(" With at most {:g} allowed, {} finds {}.",
                            frontier.allowed,
                            best->label,
                            share_text(*best->best));
}

std::vector<std::string> notes_of(const InspectorFrontier& frontier) {
  return {
      fmt::format("{} simulated parts with defects drawn anew and {} flawless ones pass under the "
                  "scene's light, each with noise of its own and the same for every filter.",
                  frontier.parts,
                  frontier.flawless),
      "Each filter looks where the flawless part itself has little response; defects elsewhere "
      "count as missed. Thresholds are multiples of its response's robust deviation.",
      "A defect is found when a blob's middle lies within inspection.trials.hit_radii of its "
      "radii; "
      "false reports are counted on flawless parts. max_reports is left out.",
      "CPU time is that of one thread from a picture's mean image to the list of defects, the best "
      "of several."};
}

InspectorFrontier measure(const Study& study, const FrontierRun& run) {
  Progress bar(study.name, kProgressSteps, run.progress);
  const auto show = [&](double done, const std::string& next) {
    bar.update(static_cast<std::int64_t>(done * kProgressSteps), next);
  };
  try {
    InspectorFrontier frontier = measure_inspectors(
        study.scene, {.threads = run.threads, .budget_s = run.budget_s, .on_progress = show});
    bar.update(kProgressSteps);
    return frontier;
  } catch (const ConfigError& error) {
    throw with_place(study.root, error);
  }
}

}  // namespace

Json inspector_json(const Study& study, const InspectorFrontier& frontier) {
  Json points = Json::array();
  for (const InspectorPoint& point : frontier.points) {
    points.push_back(point_json(point));
  }
  return {{"schema", 1},
          {"status", "done"},
          {"study", study.name},
          {"title", study.title},
          {"parts", frontier.parts},
          {"flawless", frontier.flawless},
          {"allowed_false_reports", frontier.allowed},
          {"sentence", sentence_of(frontier)},
          {"points", points},
          {"report", "inspector.html"}};
}

Json inspector_study(const Study& study, const FrontierRun& run) {
  const auto start = Clock::now();
  check_frontier_folder(study, run.out);
  { const OutputFolder probe(run.out); }  // refused now rather than after all the work
  const InspectorFrontier frontier = measure(study, run);
  Json json = inspector_json(study, frontier);
  const double taken_s = std::chrono::duration<double>(Clock::now() - start).count();
  write_frontier_folder(study,
                        run.out,
                        {{"inspector.json", json.dump(2) + "\n"},
                         {"inspector.html",
                          frontier_page_html(study,
                                             "Defects found against false reports",
                                             json["sentence"],
                                             "inspector",
                                             json,
                                             notes_of(frontier))}},
                        {{"threads", run.threads}, {"timings", {{"this_run_s", taken_s}}}});
  json["report"] = (run.out / "inspector.html").string();
  return json;
}

}  // namespace glint
