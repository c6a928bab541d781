// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/comparison/several_runs.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "studies/output/result_folder.h"
#include "studies/report/report.h"
#include "studies/run/comparison/run_comparison.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

Json best_so_far(const Json& single) {
  Json curve = Json::array();
  const bool is_maximised = single["objective"]["sense"] == "maximise";
  std::optional<double> best;
  for (const Json& trial : single["trials"]) {
    if (!trial["failed"].get<bool>() && trial["feasible"].get<bool>()) {
      const auto value = trial["objective"].get<double>();
      const bool is_better = !best || (is_maximised ? value > *best : value < *best);
      best = is_better ? value : *best;
    }
    curve.push_back(best ? Json(*best) : Json(nullptr));
  }
  return curve;
}

/// What tells a run's folder from others: its name, or where it is a verb's own (out/gear/run) that
/// of the folder it is in.
std::string own_name(const fs::path& run) {
  fs::path folder = fs::absolute(run).lexically_normal();
  folder = folder.filename().empty() ? folder.parent_path() : folder;
  const bool is_of_verb =
      folder.filename() == default_result_folder("", ResultKind::kRun).filename();
  return (is_of_verb ? folder.parent_path() : folder).filename().string();
}

void disambiguate(std::vector<std::string>& labels,
                  const std::vector<ReportedRun>& runs,
                  std::string (*name)(const ReportedRun&)) {
  const std::vector<std::string> before = labels;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (std::ranges::count(before, before[i]) > 1) {
      labels[i] = fmt::format("{} ({})", runs[i].study.title, name(runs[i]));
    }
  }
}

/// Titles of the studies; with the folders' names where two have the same, or with their paths
/// where these are the same, too.
std::vector<std::string> run_labels(const std::vector<ReportedRun>& runs) {
  std::vector<std::string> labels;
  std::ranges::transform(
      runs, std::back_inserter(labels), [](const ReportedRun& run) { return run.study.title; });
  disambiguate(labels, runs, [](const ReportedRun& run) { return own_name(run.folder); });
  disambiguate(labels, runs, [](const ReportedRun& run) { return run.folder.string(); });
  return labels;
}

/// Of each run the number of the first one of its group. All members of a group are comparable with
/// one another: that a run varies a key does not make two others comparable that set it.
std::vector<std::size_t> groups_of(const std::vector<ReportedRun>& runs) {
  std::vector<std::size_t> groups;
  const auto is_of = [&](std::size_t first, const Study& study) {
    for (std::size_t i = first; i < groups.size(); ++i) {
      if (groups[i] == first && !is_comparable(study, runs[i].study)) {
        return false;
      }
    }
    return true;
  };
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::size_t first = 0;
    while (first < i && (groups[first] != first || !is_of(first, runs[i].study))) {
      ++first;
    }
    groups.push_back(first);
  }
  return groups;
}

/// The report on a run of its own, without pictures.
Json plain_report(const Json& single) {
  Json data = {{"designs", Json::array()}};
  for (const char* name : {"status", "objective", "constraints", "trials"}) {
    if (single.contains(name)) {
      data[name] = single[name];
    }
  }
  for (const Json& design : single["designs"]) {
    Json scored = Json::object();
    for (const char* name :
         {"key", "title", "role", "feasible", "scores", "rescored", "repeated"}) {
      if (design.contains(name)) {
        scored[name] = design[name];
      }
    }
    data["designs"].push_back(std::move(scored));
  }
  return complete_report(data);
}

/// The key of the first in the ranking of designs without a search; the first one's without an
/// objective.
std::string best_of_designs(const Json& report) {
  const Json ranking = report.value("ranking", Json::array());
  return ranking.empty() ? report["designs"].at(0)["key"] : ranking.front()["key"];
}

/// What its own report holds against a run's outcome, apart from the worst defect.
Json doubts_of(const Json& report) {
  Json doubts = Json::array();
  for (const Json& finding : report["verdict"]["findings"]) {
    if (finding["code"] == "limit_lost" || finding["code"] == "objective_flat") {
      doubts.push_back(finding);
    }
  }
  return doubts;
}

/// What stands for a run in the comparison.
void represent(const Json& single, Json& run) {
  const Json report = plain_report(single);
  run["doubts"] = doubts_of(report);
  const std::string key = single.contains("status") ? "winner" : best_of_designs(report);
  const auto& designs = single["designs"];
  const auto design =
      std::ranges::find_if(designs, [&](const Json& one) { return one["key"] == key; });
  if (design == designs.end()) {  // a search that found nothing
    run["feasible"] = false;
    return;
  }
  run["scores"] = (*design)["scores"];
  run["rescored"] = design->value("rescored", Json::object());
  run["repeated"] = design->value("repeated", Json::object());
  run["feasible"] = design->value("feasible", true);
  if (key != "winner" && designs.size() > 1) {
    run["design"] = design->value("title", key);
  }
}

Json run_json(const ReportedRun& reported, const Study& first) {
  const Json& single = reported.data;
  Json run = {{"differs", differences(first, reported.study)}};
  for (const char* name : {"objective", "constraints"}) {
    if (single.contains(name)) {
      run[name] = single[name];
    }
  }
  if (single.contains("status")) {
    run["status"] = single["status"];
    run["evaluations"] = reported.result["evaluations"];
    run["failed"] = reported.result["failed"];
    run["best_so_far"] = best_so_far(single);
  }
  represent(single, run);
  return run;
}

}  // namespace

Json several_runs(std::vector<ReportedRun> runs) {
  Json data = {{"title", "Comparison of runs"}};
  const std::vector<std::string> labels = run_labels(runs);
  const std::vector<std::size_t> groups = groups_of(runs);
  Json designs = Json::array();
  Json rows = Json::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    Json run = run_json(runs[i], runs.front().study);
    run["title"] = labels[i];
    run["group"] = groups[i];
    if (run.contains("objective") && !data.contains("objective")) {
      data["objective"] = run["objective"];
    }
    for (Json& design : runs[i].data["designs"]) {
      const auto key = design["key"].get<std::string>();
      design["run"] = labels[i];
      design["title"] = fmt::format("{}, {}", design.value("title", key), labels[i]);
      design["key"] = fmt::format("run {} {}", i + 1, key);
      designs.push_back(std::move(design));
    }
    rows.push_back(std::move(run));
  }
  data["designs"] = std::move(designs);
  data["runs"] = std::move(rows);
  return data;
}

}  // namespace glint
