// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/study_search.h"

#include <filesystem>
#include <utility>

#include <nlohmann/json.hpp>

#include "optimizer/front/compromise.h"
#include "studies/accuracy/chosen_accuracy.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kErrorsPerHalf = 2.0;  // as objective_noise()

Json design_of_front(const Study& study, const Trial& trial) {
  const Scores& known = trial.outcome->scores;
  Json scores = Json::object();
  Json errors = Json::object();
  for (const Objective& objective : objectives_of(study.goal)) {
    scores[objective.name] = known.at(objective.name);
    if (const double noise = objective_noise(objective, known); noise > 0.0) {
      errors[objective.name] = noise / kErrorsPerHalf;
    }
  }
  for (const Constraint& constraint : study.goal.constraints) {
    scores[constraint.name] = known.at(constraint.name);
  }
  return {{"trial", trial.number},
          {"variables", variables_json(study, trial.point)},
          {"scores", scores},
          {"errors", errors}};
}

}  // namespace

Json variables_json(const Study& study, const Point& point) {
  Json json = Json::object();
  for (const auto& [path, value] : overrides_of(study, point)) {
    switch (value.kind) {
      case ConfigNode::Kind::kBoolean:
        json[path] = value.boolean;
        break;
      case ConfigNode::Kind::kInteger:
        json[path] = value.integer;
        break;
      case ConfigNode::Kind::kNumber:
        json[path] = value.number;
        break;
      default:
        json[path] = value.text;
    }
  }
  return json;
}

Json baseline_variables_json(const Study& study) {
  Json json = Json::object();
  for (const Variable& variable : study.space.variables) {
    const ConfigNode& node = *study.resolved.at_path(variable.name);
    if (node.is_number()) {
      json[variable.name] = node.number;
    } else if (node.kind == ConfigNode::Kind::kBoolean) {
      json[variable.name] = node.boolean;
    } else {
      json[variable.name] = node.text;
    }
  }
  return json;
}

Json front_json(const Study& study, const Storage& storage) {
  const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
  const TradeOff found = trade_off(study.goal, trials, recorded_reference(storage.events()));
  const std::vector<double> reference = in_score_units(study.goal, found.reference);
  const std::vector<Objective> objectives = objectives_of(study.goal);
  Json json = {{"objectives", Json::array()}, {"designs", Json::array()}};
  Json at = Json::object();
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    const Json value = reference.empty() ? Json(nullptr) : Json(reference[i]);
    json["objectives"].push_back(
        {{"score", objectives[i].name},
         {"direction", objectives[i].is_maximised ? "maximise" : "minimise"},
         {"reference", value}});
    at[objectives[i].name] = value;
  }
  for (const int number : found.trials) {
    json["designs"].push_back(design_of_front(study, trials[static_cast<std::size_t>(number - 1)]));
  }
  json["hypervolume"] = found.hypervolume;
  json["noise"] = found.noise;
  json["history"] = hypervolume_history(study.goal, trials, found.reference);
  json["reference"] = at;
  json["outside"] = found.outside;
  json["chosen"] = nullptr;
  if (!found.trials.empty()) {
    json["chosen"] = {{"trial", found.trials[found.chosen]},
                      {"by", choice_rule_name(study.goal.choice)},
                      {"reason", found.reason}};
  }
  return json;
}

SearchTask search_task(const Study& study, int jobs) {
  return {.space = study.space,
          .settings = study.search,
          .goal = study.goal,
          .budget = study.budget,
          .start_points = {baseline_point(study)},
          .jobs = jobs};
}

WantedScores wanted_in_search(const Study& study) {
  WantedScores wanted = wanted_in_trial(study);
  if (needs_gradient(study.search.algorithm)) {
    wanted.gradients = wanted_with_gradients(study.goal, study.space).gradients;
  }
  return wanted;
}

Outcome evaluate_candidate(SceneStore& store,
                           const Study& study,
                           const Point& point,
                           const RenderRung* rung) {
  const std::filesystem::path& file = study.scene.part.file;
  if (!file.empty() && !std::filesystem::exists(file)) {
    throw IoError(file.string() + ": has gone while the study was running");
  }
  SceneSettings scene = scene_with(study, overrides_of(study, point));
  if (rung != nullptr) {
    scene = at_rung(std::move(scene), *rung);
  }
  Evaluation found = evaluate(store, scene, {}, wanted_in_search(study));
  Outcome outcome;
  outcome.scores = std::move(found.scores);
  outcome.gradients = std::move(found.gradients.by_score);
  outcome.remarks = std::move(found.gradients.remarks);
  return outcome;
}

}  // namespace glint
