// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/check_study.h"

#include <algorithm>
#include <chrono>
#include <set>

#include <nlohmann/json.hpp>

#include "core/wall_clock.h"
#include "studies/definition/render_methods.h"
#include "studies/definition/scene_notes.h"
#include "studies/imaging/defect_windows.h"
#include "studies/imaging/path_picture.h"
#include "studies/population/pod_study.h"
#include "studies/population/sorting.h"
#include "studies/run/design_files.h"
#include "studies/run/repeated_scores.h"

namespace glint {

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

/// Everything about a scene that can be refused before anything is written.
void check_scene(SceneStore& store, const SceneSettings& scene) {
  check_part_in_tunnel(store, scene);
  store.trace(first_view(store, scene));
}

/// What the ends of the variables' ranges show.
struct Sensitivity {
  std::vector<std::string> idle;  ///< variables that change no score: a key of another shape, often
  std::set<double> objectives;    ///< values of the objective that were seen
};

Sensitivity sensitivity(SceneStore& store, const Study& study) {
  const WantedScores wanted = wanted_by(study.goal).with_whole_scan();
  Sensitivity found;
  const Point start = baseline_point(study);
  for (std::size_t i = 0; i < study.space.variables.size(); ++i) {
    const Variable& variable = study.space.variables[i];
    const auto scores_at = [&](double value) {
      Point point = start;
      point[i] = value;
      const Overrides overrides = overrides_of(study, canonical(study.space, point));
      Scores scores = evaluate(store, scene_with(study, overrides), {}, wanted).scores;
      if (const auto found_score = scores.find(study.goal.objective.name);
          found_score != scores.end()) {
        found.objectives.insert(found_score->second);
      }
      return scores;
    };
    const bool is_choice = variable.kind == Variable::Kind::kChoice;
    const double last = static_cast<double>(variable.choices.size()) - 1.0;
    try {
      if (is_active(study.space, start, i) && scores_at(is_choice ? 0.0 : variable.low) ==
                                                  scores_at(is_choice ? last : variable.high)) {
        found.idle.push_back(variable.name);
      }
    } catch (const ConfigError&) {
      continue;  // an end that cannot be built: the variable does act
    }
  }
  return found;
}

/// The study's own scene as costly as a candidate of the search: its picture is not known yet where
/// a variable changes pictures.
SceneSettings as_searched(const Study& study) {
  SceneSettings scene = study.scene;
  scene.paths.seed += study.has_search() ? 0 : 1;  // each repeated scan has noise of its own
  const Point start = baseline_point(study);
  const auto key_at = [&](std::size_t variable, double value) {
    Point point = start;
    point[variable] = value;
    const Overrides overrides = overrides_of(study, canonical(study.space, point));
    const SceneSettings at = scene_with(study, overrides);
    return picture_key(at, at.viewpoint());
  };
  for (std::size_t i = 0; i < study.space.variables.size(); ++i) {
    const Variable& variable = study.space.variables[i];
    const bool is_choice = variable.kind == Variable::Kind::kChoice;
    const double last = static_cast<double>(variable.choices.size()) - 1.0;
    if (key_at(i, is_choice ? 0.0 : variable.low) != key_at(i, is_choice ? last : variable.high)) {
      ++scene.paths.seed;
      break;
    }
  }
  return scene;
}

/// Remarks on the study's own scene.
std::vector<std::string> baseline_notes(SceneStore& store,
                                        const Study& study,
                                        const Evaluation& baseline) {
  const SceneSettings scene = first_view(store, study.scene);
  const auto view = path_view_of(scene, baseline.traced->part);
  return notes_of(study.scene, baseline.scores, view.get());
}

/// Seconds for the parts of the study's populations; 0 without any.
double predicted_population_s(const Study& study, SceneStore& store) {
  return (study.sorting ? predicted_sorting_s(study, store) : 0.0) +
         (study.pod ? predicted_pod_s(study, store) : 0.0);
}

/// Seconds for designs without a search: each is written once, scored again with finer sampling,
/// and scanned repeatedly. @param per_scan_s  of one scan of them all
double predicted_designs_s(const Study& study, double per_scan_s) {
  const double finer = frame_method(study.scene).name == "paths" ? 4.0 : 2.0;
  return study.has_objective ? per_scan_s * (1.0 + finer + kRepeatedScans) : 0.0;
}

}  // namespace

void check_everything(SceneStore& store, const Study& study) {
  try {
    check_scene(store, study.scene);
  } catch (const ConfigError& error) {
    throw with_place(study.root, error);
  }
  for (const Prototype& prototype : study.prototypes) {
    try {
      check_scene(store, scene_with(study, prototype.overrides));
    } catch (const ConfigError& error) {
      throw prototype_error(prototype, error);
    }
  }
}

Json check_study(const Study& study, int threads, int jobs) {
  ThreadPool pool(threads);
  SceneStore store(pool);
  check_everything(store, study);
  Json designs = Json::object();
  const WantedScores wanted = wanted_by(study.goal).with_whole_scan();
  evaluate(store, study.scene);  // the first one pays for tracing and cold caches
  const auto start = Clock::now();
  const Evaluation baseline = evaluate(store, as_searched(study), {}, wanted);
  const double per_evaluation_s = seconds_since(start);
  double all_designs_s = per_evaluation_s;
  for (const Prototype& prototype : study.prototypes) {
    const auto prototype_start = Clock::now();
    const Evaluation evaluation =
        evaluate(store, scene_with(study, prototype.overrides), {}, wanted);
    all_designs_s += seconds_since(prototype_start);
    designs[prototype.name] = {{"scores", scores_json(evaluation.scores)}};
  }
  const Sensitivity ends = study.has_search() ? sensitivity(store, study) : Sensitivity();
  std::vector<std::string> notes = baseline_notes(store, study, baseline);
  if (const std::string narrow = narrow_defects_note(*baseline.traced, study.scene);
      !narrow.empty()) {
    notes.push_back(narrow);
  }
  const int at_once = std::max(1, std::min(jobs, study.search.batch));
  double predicted_s = per_evaluation_s * study.budget.evaluations / at_once;
  if (study.budget.wall_clock_s > 0.0 &&
      (study.budget.evaluations == 0 || study.budget.wall_clock_s < predicted_s)) {
    predicted_s = study.budget.wall_clock_s;
  }
  return {{"schema", 1},
          {"status", "done"},
          {"name", study.name},
          {"variables", study.space.variables.size()},
          {"objective", study.goal.objective.name},
          {"idle_variables", ends.idle},
          {"is_objective_flat", ends.objectives.size() == 1},
          {"baseline", {{"scores", scores_json(baseline.scores)}, {"notes", notes}}},
          {"prototypes", designs},
          {"evaluations", study.has_search() ? study.budget.evaluations : 0},
          {"seconds_per_evaluation", per_evaluation_s},
          {"predicted_s",
           study.has_search()       ? predicted_s
           : study.has_population() ? predicted_population_s(study, store)
                                    : predicted_designs_s(study, all_designs_s)}};
}

}  // namespace glint
