// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/run_report.h"
#include "studies/definition/study_text.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/image_io.h"
#include "core/text.h"
#include "core/units.h"
#include "studies/accuracy/accuracy_panel.h"
#include "studies/definition/render_methods.h"
#include "studies/definition/scene_notes.h"
#include "studies/front/front_page.h"
#include "studies/output/provenance.h"
#include "studies/output/read_json.h"
#include "studies/population/population_report.h"
#include "studies/population/population_verdict.h"
#include "studies/report/report.h"
#include "studies/report/report_kinds.h"
#include "studies/run/comparison/several_runs.h"
#include "studies/run/results/noise_panel.h"
#include "studies/run/results/scene_facts.h"
#include "studies/run/run_closeups.h"
#include "studies/run/study_search.h"
#include "studies/tolerance/tolerance_panel.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr int kFrameWidth_px = 650;
constexpr std::size_t kPageItself_bytes = 1'500'000;  // script, style, licences; generously

Json frames(const fs::path& folder) {
  Json list = Json::array();
  for (int k = 0;; ++k) {
    const fs::path file = folder / "sequence" / fmt::format("frame_{:03}.png", k);
    if (!fs::exists(file)) {
      return list;
    }
    list.push_back(report_png(read_image(file), kFrameWidth_px));
  }
}

Json design_json(const fs::path& folder,
                 const std::string& key,
                 bool has_frames,
                 const std::string& objective) {
  Json json = read_json(folder / "scores.json");
  json["key"] = key;
  const ImageF aspect = read_image(folder / "aspect.exr");
  const bool is_one_picture = has_frames && !fs::exists(folder / "sequence/frame_001.png");
  if (!is_one_picture) {  // of which there is no mean beside it
    json["aspect"] = report_png(aspect, 2 * kFrameWidth_px);
  }
  json["drawing"] = read_file(folder / "cross_section.svg");
  json["closeups"] = closeups_of(folder, aspect, objective);
  json["defects"] = defect_widths(folder);
  if (has_frames) {
    json["frames"] = frames(folder);
  }
  return json;
}

std::string_view kind_text(Variable::Kind kind) {
  return kind == Variable::Kind::kFloat     ? "float"
         : kind == Variable::Kind::kInteger ? "integer"
                                            : "choice";
}

Json variables_json(const Study& study) {
  Json list = Json::array();
  for (const Variable& variable : study.space.variables) {
    // "control_mm.2": the unit stands in the last named part.
    std::string key = variable.name;
    while (!key.empty() && key.find_last_not_of("0123456789.") + 1 != key.size()) {
      key.resize(key.find_last_not_of("0123456789.") + 1);
    }
    list.push_back({{"name", variable.name},
                    {"kind", kind_text(variable.kind)},
                    {"low", variable.low},
                    {"high", variable.high},
                    {"log", variable.is_log},
                    {"unit", std::string(written_unit(key))},
                    {"choices", variable.choices}});
  }
  return list;
}

Json trial_json(const Study& study, const Trial& trial, const std::string& algorithm) {
  Json values = Json::array();
  for (std::size_t i = 0; i < trial.point.size(); ++i) {
    const Variable& variable = study.space.variables[i];
    if (!is_active(study.space, trial.point, i)) {
      values.push_back(nullptr);
    } else if (variable.kind == Variable::Kind::kChoice) {
      values.push_back(variable.choices[static_cast<std::size_t>(trial.point[i])]);
    } else {
      values.push_back(trial.point[i]);
    }
  }
  Json json = {{"number", trial.number}, {"kind", algorithm}, {"values", values}};
  const Outcome& outcome = *trial.outcome;
  json["failed"] = outcome.is_failed;
  if (outcome.is_failed) {
    json["message"] = without_folders(outcome.message, study);
    return json;
  }
  json["feasible"] = is_feasible(study.goal, outcome.scores);
  json["objective"] = outcome.scores.at(study.goal.objective.name);
  Json scores = Json::object();
  for (const auto& [name, value] : outcome.scores) {
    const bool is_summary = name.find("defects.") != 0 || name.find('.', 8) == std::string::npos;
    const bool is_named =
        std::ranges::count(study.goal.constraints, name, &Constraint::name) > 0 ||
        std::ranges::count(study.goal.more_objectives, name, &Objective::name) > 0;
    if (is_summary || is_named) {
      scores[name] = value;
    }
  }
  json["scores"] = scores;
  return json;
}

void add_goal(const Study& study, Json& data) {
  data["objective"] = {{"name", study.goal.objective.name},
                       {"sense", study.goal.objective.is_maximised ? "maximise" : "minimise"}};
  Json constraints = Json::array();
  for (const Constraint& constraint : study.goal.constraints) {
    Json json = {{"name", constraint.name}};
    if (constraint.min) {
      json["min"] = *constraint.min;
    }
    if (constraint.max) {
      json["max"] = *constraint.max;
    }
    constraints.push_back(json);
  }
  data["constraints"] = constraints;
}

void add_search(const Study& study, const fs::path& run, Json& data) {
  data["variables"] = variables_json(study);
  const std::string algorithm =
      resolved_algorithm(study.space, study.search, num_objectives(study.goal));
  Json trials = Json::array();
  const Storage storage = Storage::read(run / "study.sqlite");
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    if (trial.outcome) {
      trials.push_back(trial_json(study, trial, algorithm));
    }
  }
  data["trials"] = trials;
}

std::vector<std::string> design_keys(const Study& study, const fs::path& run) {
  std::vector<std::string> keys = {"baseline"};
  for (const Prototype& prototype : study.prototypes) {
    keys.push_back(prototype.name);
  }
  keys.emplace_back("winner");
  std::erase_if(keys,
                [&](const std::string& key) { return !fs::exists(run / key / "scores.json"); });
  return keys;
}

Study study_of(const fs::path& run) {
  if (!fs::exists(run / "study.resolved.toml")) {
    throw IoError(
        fmt::format("{}: is no run directory: study.resolved.toml is missing", run.string()));
  }
  return load_study(run / "study.resolved.toml", {});
}

/// How often a remark was made, and with which counts.
struct RemarkCount {
  int evaluations = 0;
  std::int64_t fewest = 0;
  std::int64_t maximum = 0;
};

/// What was simulated: the study's own scene.
Json scene_json(const Study& study, const fs::path& run, const Json& result) {
  Json scene = {
      {"facts",
       scene_facts(
           study.scene, result.value("part", Json()), result.value("study", std::string()))}};
  const fs::path folder = run / "baseline";
  if (!fs::exists(folder / "defects.json")) {
    return scene;
  }
  const Json defects = read_json(folder / "defects.json")["defects"];
  scene["defects"] = defect_table(defects);
  if (fs::exists(folder / "part.png")) {
    scene["picture"] = base64(read_file(folder / "part.png"));
    scene["note"] = "The part as the camera sees it, shaded; its lighting is not drawn.";
    scene["size_px"] = {study.scene.camera.width_px, study.scene.camera.height_px};
    scene["marks"] = Json::array();
    for (const Json& defect : defects) {
      scene["marks"].push_back({{"label", defect["label"]}, {"window_px", marked_px(defect)}});
    }
  }
  return scene;
}

/// "2026-11-23 08:10:05 UTC, 1 min 7 s"; empty where run.json does not tell.
std::string when_text(const fs::path& run) {
  const Json json = fs::exists(run / "run.json") ? read_json(run / "run.json") : Json::object();
  if (!json.contains("started")) {
    return "";
  }
  const Json& timings = json["timings"];
  return moment_text(json["started"].get<std::string>(), timings["this_run_s"].get<double>()) +
         (timings.value("replayed_evaluations", 0) > 0 ? " since it was resumed" : "");
}

std::vector<std::string> method_sentences(const Study& study, const fs::path& run) {
  std::vector<std::string> methods = method_notes(study.scene);
  if (study.has_search() && !wanted_in_search(study).changes) {
    methods.emplace_back(
        "Changes of defects against the flawless part were not computed for the designs of the "
        "search, as neither objective nor limits need them (search.scores); finalists have them.");
  }
  if (study.has_search()) {
    for (const std::string& remark : derivative_remarks(Storage::read(run / "study.sqlite"))) {
      methods.push_back("Derivatives of the search do not include: " + remark + ".");
    }
  }
  return methods;
}

/// The winner's race and true value, and how probably each design is the best.
void add_noise_to_page(const Json& result, Json& data) {
  const Json best = result.value("best", Json());
  const Json told = best.is_object() ? best.value("told", Json()) : Json();
  const Json race = result.value("race", Json());
  if (told.is_null() && race.is_null()) {
    return;
  }
  data["panels"].push_back(noise_panel(data["objective"]["name"], race, told));
  if (!race.is_null()) {
    data["probability_best"] = result["probability_best"];
    data["race"] = race;
  }
}

Json single_run(const fs::path& run) {
  const Study study = study_of(run);
  const Json result = read_json(run / "result.json");
  if (result.contains("views")) {
    throw ConfigError(
        run.string() +
        ": holds rendered views, whose page is report.html; there is no run to report");
  }
  Json data = {{"title", study.title}, {"subtitle", "Lighting study for surface inspection"}};
  if (study.has_objective) {
    add_goal(study, data);
  }
  if (study.has_search()) {
    data["status"] = result["status"];
    add_search(study, run, data);
  }
  if (study.has_search() && has_several_objectives(study.goal)) {
    data["front"] = front_json(study, Storage::read(run / "study.sqlite"));
    const auto closeups = [&](const fs::path& folder, const ImageF& aspect) {
      return closeups_of(folder, aspect, study.goal.objective.name);
    };
    add_front_to_page(run, result, closeups, data["front"]);
  }
  const std::string objective = study.has_objective ? study.goal.objective.name : "";
  Json designs = Json::array();
  for (const std::string& key : design_keys(study, run)) {
    designs.push_back(design_json(run / key, key, true, objective));
  }
  data["designs"] = designs;
  data["scene"] = scene_json(study, run, result);
  if (study.has_population()) {
    data["panels"] = population_panels(run, result);
  }
  if (result.contains("accuracy")) {
    data["panels"].push_back(accuracy_panel(result["accuracy"]));
  }
  add_noise_to_page(result, data);
  if (!result.value("kinds", Json::array()).empty()) {
    data["kinds"] = result["kinds"];
    data["panels"].push_back(report_detail::kinds_panel(data));
  }
  if (result.contains("manufacture")) {
    data["panels"].push_back(tolerance_panel(result["manufacture"], result["best"]["variables"]));
  }
  if (fs::exists(run / "frontier.json")) {
    data["frontier"] = read_json(run / "frontier.json");
  }
  data["methods"] = method_sentences(study, run);
  data["config_toml"] = shown_text(study);
  Json source = provenance();
  source["seed"] = study.search.seed;
  source.erase("cores");
  data["provenance"] = source;
  data["when"] = when_text(run);
  if (data.contains("front")) {
    limit_sequences(data, kMaxPageBytes - kPageItself_bytes);
  }
  return data;
}

void check_has_one_objective(const Study& study, const fs::path& run) {
  if (has_several_objectives(study.goal)) {
    throw ConfigError(run.string() +
                      ": has several objectives, and runs side by side are compared by one; "
                      "report it by itself");
  }
}

}  // namespace

nlohmann::ordered_json report_data(const std::vector<fs::path>& runs) {
  if (runs.size() == 1) {
    Json data = complete_report(single_run(runs.front()));
    data["verdict"] =
        with_population_verdict(data["verdict"], read_json(runs.front() / "result.json"));
    return data;
  }
  std::vector<ReportedRun> several;
  for (const fs::path& run : runs) {
    Study study = study_of(run);
    check_has_one_objective(study, run);
    Json data = single_run(run);
    Json result = read_json(run / "result.json");
    several.push_back({run, std::move(study), std::move(data), std::move(result)});
  }
  return complete_report(several_runs(std::move(several)));
}

std::string report_html(const std::vector<fs::path>& runs) {
  return render_report(report_data(runs));
}

std::vector<std::string> derivative_remarks(const Storage& storage) {
  using RemarkKind = std::pair<bool, std::string>;  // those with a count come first
  std::map<RemarkKind, RemarkCount> counts;
  int evaluations = 0;
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    if (!trial.outcome || trial.outcome->is_failed || trial.outcome->gradients.empty()) {
      continue;
    }
    ++evaluations;
    for (const Remark& remark : trial.outcome->remarks) {
      const std::int64_t number = remark.count.value_or(0);
      RemarkCount& count = counts[{!remark.count, remark.text}];
      count.fewest = count.evaluations == 0 ? number : std::min(count.fewest, number);
      count.maximum = std::max(count.maximum, number);
      ++count.evaluations;
    }
  }
  std::vector<std::string> remarks;
  for (const auto& [kind, count] : counts) {
    const auto& [has_no_count, text] = kind;
    const std::string number = has_no_count ? ""
                               : count.fewest == count.maximum
                                   ? fmt::format("{} ", count.maximum)
                                   : fmt::format("{} to {} ", count.fewest, count.maximum);
    remarks.push_back(
        fmt::format("{}{} ({} of {} evaluations)", number, text, count.evaluations, evaluations));
  }
  return remarks;
}

}  // namespace glint
