// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/check_study.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/cpu_clock.h"
#include "core/text.h"
#include "studies/accuracy/accurate_search.h"
#include "studies/accuracy/budget_note.h"
#include "studies/definition/manufacture.h"
#include "studies/front/front_designs.h"
#include "studies/imaging/defect_windows.h"
#include "studies/imaging/path_warnings.h"
#include "studies/population/pod_study.h"
#include "studies/population/sorting.h"
#include "studies/report/report.h"
#include "studies/run/design_files.h"
#include "studies/run/repeated_scores.h"
#include "studies/run/run_costs.h"
#include "studies/run/search_race.h"
#include "studies/tolerance/built_designs.h"

namespace glint {

namespace {

using Json = nlohmann::ordered_json;

/// Everything about a scene that can be refused before anything is written.
void check_scene(SceneStore& store, const SceneSettings& scene) {
  check_cameras_outside_part(store, scene);
  check_part_in_tunnel(store, scene);
  const SceneSettings first = first_view(store, scene);
  store.trace(first);
  [[maybe_unused]] const SceneLamps refuses_lamps_that_hide_each_other(first,
                                                                       store.build_defects(first));
}

/// One end of a variable's range, or one of its choices.
struct VariableEnd {
  double value = 0.0;
  std::string name;  ///< "60, its max", "\"ring\", one of its choices"
};

/// A choice has its first and its last one.
std::vector<VariableEnd> ends_of(const Variable& variable) {
  if (variable.kind != Variable::Kind::kChoice) {
    return {{variable.low, shortest(variable.low) + ", the min of its variable"},
            {variable.high, shortest(variable.high) + ", the max of its variable"}};
  }
  const auto choice = [&](std::size_t index) {
    return VariableEnd{static_cast<double>(index),
                       fmt::format("\"{}\", a choice of its variable", variable.choices[index])};
  };
  return {choice(0), choice(variable.choices.size() - 1)};
}

/// Which variables do what: looked at between the ends of their ranges, the others at the baseline.
class VariableCheck {
 public:
  VariableCheck(SceneStore& store, const Study& study)
      : store_(store), study_(study), start_(baseline_point(study)) {}

  /// Ends that break a rule between keys, found without rendering anything.
  void read_ends() {
    for (std::size_t i = 0; i < study_.space.variables.size(); ++i) {
      for (const VariableEnd& end : ends_of(study_.space.variables[i])) {
        try {
          scene_at(i, end);
        } catch (const ConfigError& error) {
          add_broken(i, end, error);
        }
      }
    }
  }

  /// Whether a score differs between the ends; a key of another shape makes none differ, most
  /// often.
  void add_objectives(const Scores& scores) {
    std::vector<double> values;
    for (const Objective& objective : objectives_of(study_.goal)) {
      const auto found = scores.find(objective.name);
      if (found != scores.end()) {
        values.push_back(found->second);
      }
    }
    if (!values.empty()) {
      objectives_.insert(std::move(values));
    }
  }

  void evaluate_ends(std::size_t index) {
    const WantedScores wanted = wanted_by(study_.goal).with_whole_scan();
    const Variable& variable = study_.space.variables[index];
    if (!is_active(study_.space, start_, index)) {
      return;
    }
    std::vector<Scores> scores;
    for (const VariableEnd& end : ends_of(variable)) {
      try {
        scores.push_back(evaluate(store_, scene_at(index, end), {}, wanted).scores);
        add_objectives(scores.back());
      } catch (const ConfigError& error) {  // an end that cannot be built: the variable does act
        add_broken(index, end, error);
      }
    }
    if (scores.size() == 2 && scores.front() == scores.back()) {
      idle_.push_back(variable.name);
    }
  }

  const std::vector<std::string>& idle() const { return idle_; }

  const std::vector<std::string>& broken() const { return broken_; }

  /// A search has nothing to go by: the objectives are the same at all ends, in the study's own
  /// scene and in another design. As a choice or a place between two ends may be better than both,
  /// these two are looked at where the ends tell nothing.
  /// @param other  empty: none is known
  bool is_objective_flat(const std::optional<Point>& other) {
    if (objectives_.size() != 1) {
      return false;
    }
    evaluate_at(start_);
    if (other) {
      evaluate_at(*other);
    }
    return objectives_.size() == 1;
  }

 private:
  void evaluate_at(const Point& point) {
    try {
      const SceneSettings scene =
          scene_with(study_, overrides_of(study_, canonical(study_.space, point)));
      add_objectives(evaluate(store_, scene, {}, wanted_by(study_.goal).with_whole_scan()).scores);
    } catch (const ConfigError&) {  // the search renders it otherwise, with fewer rays
    }
  }

  SceneSettings scene_at(std::size_t index, const VariableEnd& end) const {
    Point point = start_;
    point[index] = end.value;
    return scene_with(study_, overrides_of(study_, canonical(study_.space, point)));
  }

  void add_broken(std::size_t index, const VariableEnd& end, const ConfigError& error) {
    const std::string& name = study_.space.variables[index].name;
    const ConfigNode* table = study_.root.find("variables")->find(name);
    for (const Problem& problem : error.problems()) {
      const std::string text = fmt::format("{}{} = {}, gives a design that fails: {} {}",
                                           table->place.prefix(),
                                           name,
                                           end.name,
                                           problem.key,
                                           problem.text);
      if (std::ranges::find(broken_, text) == broken_.end()) {
        broken_.push_back(text);
      }
    }
  }

  SceneStore& store_;
  const Study& study_;
  Point start_;
  std::vector<std::string> idle_;
  std::vector<std::string> broken_;
  std::set<std::vector<double>> objectives_;
};

/// What the study judges its designs by, as limits of a report: the objective first.
Json judged_by(const Study& study) {
  Json limits = Json::array();
  if (study.has_objective) {
    limits.push_back({{"name", study.goal.objective.name}});
    limits.back()[study.goal.objective.is_maximised ? "min" : "max"] = 0.0;
  }
  for (const Constraint& constraint : study.goal.constraints) {
    limits.push_back({{"name", constraint.name}});
    if (constraint.min) {
      limits.back()["min"] = *constraint.min;
    }
  }
  return limits;
}

/// What a report would say of a defect that the study's own scene hides, beside its prototypes;
/// empty where it shows.
/// @param prototypes  by their names, each with its `scores`
std::string hidden_defect_note(const Study& study, const Json& scores, const Json& prototypes) {
  Json designs = Json::array();
  designs.push_back({{"key", "baseline"}, {"scores", scores}});
  for (const auto& [name, design] : prototypes.items()) {
    designs.push_back({{"key", name}, {"scores", design["scores"]}});
  }
  // Without an objective a report speaks of the study's own scene.
  const Json report = complete_report({{"constraints", judged_by(study)}, {"designs", designs}});
  for (const Json& finding : report["verdict"]["findings"]) {
    if (finding["code"] == "defects_hidden") {
      return (study.has_search() ? "Before the search: " : "") + finding["text"].get<std::string>();
    }
  }
  return "";
}

/// Remarks on the study's own scene.
std::vector<std::string> baseline_notes(SceneStore& store,
                                        const Study& study,
                                        const Evaluation& baseline) {
  const SceneSettings scene = first_view(store, study.scene);
  const SceneLamps lamps(scene, baseline.traced->part);
  std::vector<std::string> notes = notes_of(study.scene, baseline.scores, lamps);
  for (const std::string& note : {narrow_defects_note(*baseline.traced, study.scene),
                                  defect_stripes_note(*baseline.traced, study.scene)}) {
    if (!note.empty()) {
      notes.push_back(note);
    }
  }
  return notes;
}

/// CPU seconds for the parts of the study's populations; 0 without any.
double predicted_population_s(const Study& study, SceneStore& store) {
  return (study.sorting ? predicted_sorting_s(study, store) : 0.0) +
         (study.pod ? predicted_pod_s(study, store) : 0.0);
}

/// What is done one after the other, and how far it is.
class Check {
 public:
  Check(const Study& study, const CheckOptions& options)
      : study_(study),
        options_(options),
        pool_(options.threads),
        store_(pool_),
        variables_(store_, study),
        progress_(study.name + ": checking", num_steps(), options.progress) {}

  Json execute() {
    step("tracing rays");
    check_everything(store_, study_);
    check_has_tolerances(study_);
    check_accuracy_choice(study_, false);
    variables_.read_ends();
    choose_rung();
    if (study_.has_search()) {
      sample_ = sample_search(
          study_,
          store_,
          options_.jobs,
          [&] { step("the first designs of the search"); },
          accurate_.chosen ? std::optional(accurate_.chosen->rungs()) : std::nullopt);
    }
    render_designs();
    for (std::size_t i = 0; i < study_.space.variables.size(); ++i) {
      step("the variables");
      variables_.evaluate_ends(i);
    }
    is_objective_flat_ = variables_.is_objective_flat(sample_.best);
    step("the populations");
    costs_.populations_s = predicted_population_s(study_, store_);
    search_ = study_.has_search() ? predicted_search(study_.budget, sample_.evaluation_s, at_once())
                                  : PredictedSearch();
    costs_.search_s = accurate_.cpu_s + (search_ ? search_->cpu_s : 0.0);
    costs_.rescoring_s +=
        measure_race_s(store_,
                       study_,
                       sample_.best,
                       likely_replicates(study_, search_ ? search_->evaluations : 0));
    costs_.manufacture_s = has_manufacture() ? sample_.evaluation_s * kMaxBuiltDesigns : 0.0;
    return result();
  }

 private:
  bool has_manufacture() const { return study_.root.find("manufacture") != nullptr; }

  std::int64_t num_steps() const {
    const auto variables = static_cast<std::int64_t>(study_.space.variables.size());
    const auto prototypes = static_cast<std::int64_t>(study_.prototypes.size());
    return 3 + prototypes + variables + (study_.has_search() ? 1 + kSampledDesigns : 0) +
           (study_.accuracy ? 1 : 0);
  }

  void step(const std::string& what) { progress_.update(steps_++, what); }

  /// Where the study says how exactly scores must be known.
  void choose_rung() {
    if (study_.accuracy) {
      step("ways to render");
      const double start = process_cpu_s();
      accurate_.chosen = choose_accuracy({.study = study_, .store = store_, .jobs = options_.jobs});
      accurate_.cpu_s = process_cpu_s() - start;
    }
  }

  /// Renders and re-scores a design as a run does, and adds what that costs.
  Evaluation render(const SceneSettings& scene) {
    RenderedDesign design = render_design(store_, scene, wanted_by(study_.goal));
    costs_.writing_s += design.cpu_s;
    costs_.rescoring_s += measure_rescoring_s(store_, study_, scene, design.cpu_s);
    return std::move(design.evaluation);
  }

  void render_designs() {
    step("the baseline");
    const Evaluation baseline = render(study_.scene);
    baseline_ = {{"scores", scores_json(baseline.scores)},
                 {"notes", baseline_notes(store_, study_, baseline)}};
    for (const Prototype& prototype : study_.prototypes) {
      step("the prototypes");
      const Evaluation design = render(scene_with(study_, prototype.overrides));
      designs_[prototype.name] = {{"scores", scores_json(design.scores)}};
    }
    const std::string hidden = hidden_defect_note(study_, baseline_["scores"], designs_);
    if (!hidden.empty()) {
      baseline_["notes"].push_back(hidden);
    }
    if (sample_.best) {
      step("the best of the first designs");
      const RunCosts before = costs_;
      render(scene_with(study_, overrides_of(study_, *sample_.best)));
      if (has_several_objectives(study_.goal)) {  // and the others of the front, at most
        costs_.writing_s += (kFullDesigns - 1) * (costs_.writing_s - before.writing_s);
        costs_.rescoring_s += (kFullDesigns - 1) * (costs_.rescoring_s - before.rescoring_s);
      }
    }
  }

  int at_once() const { return std::max(1, std::min(options_.jobs, study_.search.batch)); }

  /// On a machine that has nothing else to do.
  double predicted_s() const {
    return costs_.search_s / at_once() + costs_.manufacture_s / std::max(1, options_.jobs) +
           costs_.rescoring_s + costs_.writing_s + costs_.populations_s / options_.threads;
  }

  /// Whether more evaluations fit into the time than are predicted: threads help one another.
  bool is_lower_bound() const {
    return search_ && search_->is_timed && options_.threads > at_once();
  }

  /// null where nothing tells when the search ends.
  Json known(double seconds) const { return search_ ? Json(seconds) : Json(nullptr); }

  Json names_of_objectives() const {
    Json names = Json::array();
    for (const Objective& objective : objectives_of(study_.goal)) {
      names.push_back(objective.name);
    }
    return names;
  }

  Json result() {
    Json json = plain_result();
    if (has_manufacture()) {
      json["manufacture_evaluations"] = kMaxBuiltDesigns;
      json["predicted_cpu_s"]["manufacture"] = costs_.manufacture_s;
    }
    if (accurate_.chosen) {
      json["accuracy"] =
          accurate_search_json(store_, study_, accurate_, search_ ? search_->evaluations : 0);
      add_budget_note(json["accuracy"]);
    }
    return json;
  }

  /// Where the clock ends the search before its work is done.
  void add_budget_note(Json& accuracy) const {
    if (search_ && search_->is_timed) {
      const std::string note = budget_note(study_, *accurate_.chosen, search_->evaluations);
      if (!note.empty()) {
        accuracy["within_budget"] = note;
        accuracy["sentence"] = accuracy["sentence"].get<std::string>() + " " + note;
      }
    }
  }

  Json plain_result() const {
    return {{"schema", 1},
            {"status", "done"},
            {"name", study_.name},
            {"variables", study_.space.variables.size()},
            {"objective", study_.goal.objective.name},
            {"objectives", names_of_objectives()},
            {"insensitive_variables", variables_.idle()},
            {"idle_variables", variables_.idle()},  // as older versions called them
            {"broken_limits", variables_.broken()},
            {"is_objective_flat", is_objective_flat_},
            {"baseline", baseline_},
            {"prototypes", designs_},
            {"evaluations", search_ ? Json(search_->evaluations) : Json(nullptr)},
            {"is_lower_bound", is_lower_bound()},
            {"seconds_per_evaluation", sample_.evaluation_s},
            {"predicted_cpu_s",
             {{"search", known(costs_.search_s)},
              {"rescoring", costs_.rescoring_s},
              {"writing", costs_.writing_s},
              {"populations", costs_.populations_s},
              {"total", known(costs_.total_s())}}},
            {"predicted_s", known(predicted_s())}};
  }

  const Study& study_;
  const CheckOptions& options_;
  ThreadPool pool_;
  SceneStore store_;
  VariableCheck variables_;
  bool is_objective_flat_ = false;
  Progress progress_;
  std::int64_t steps_ = 0;
  AccurateSearch accurate_;
  SearchSample sample_;
  RunCosts costs_;
  std::optional<PredictedSearch> search_;  ///< empty: nothing tells when it ends
  Json baseline_;
  Json designs_ = Json::object();
};

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

Json check_study(const Study& study, const CheckOptions& options) {
  return Check(study, options).execute();
}

}  // namespace glint
