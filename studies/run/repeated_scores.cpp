// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/repeated_scores.h"

#include <chrono>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/wall_clock.h"
#include "optimizer/algorithm/merit.h"
#include "studies/definition/render_methods.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::set<std::string> kept_scores(const Goal& goal) {
  std::set<std::string> names = {"defects.min_cnr"};
  for (const Objective& objective : objectives_of(goal)) {
    names.insert(objective.name);
  }
  for (const Constraint& constraint : goal.constraints) {
    names.insert(constraint.name);
  }
  return names;
}

Outcome outcome_of_scan(SceneStore& store,
                        const SceneSettings& scene,
                        const WantedScores& wanted,
                        int index) {
  const auto start = std::chrono::steady_clock::now();
  Outcome outcome;
  try {
    outcome.scores = repeated_scan(store, scene, wanted, index);
  } catch (const ConfigError& error) {
    outcome = {.is_failed = true, .message = error.what()};
  }
  outcome.seconds = seconds_since(start);
  return outcome;
}

}  // namespace

WantedScores wanted_of_repeats(const Study& study) {
  WantedScores wanted = wanted_by(study.goal);
  wanted.picture = true;
  wanted.coverage = false;  // noise does not change it
  wanted.reference = false;
  wanted.reach = false;
  wanted.lighting = false;
  return study.has_search() ? wanted.of_one_scan() : wanted;
}

Scores repeated_scan(SceneStore& store,
                     const SceneSettings& scene,
                     const WantedScores& wanted,
                     int index) {
  WantedScores scan = wanted;
  scan.gradients = {};
  scan.errors = false;
  scan.defects = true;
  scan.first_part = (index + 2) * kFreshParts;
  return evaluate(store, repeated_settings(scene, index), {}, scan).scores;
}

Json repeated_scores(SceneStore& store,
                     const SceneSettings& scene,
                     const WantedScores& wanted,
                     const Goal& goal,
                     const OnRepeatedScan& on_scan) {
  const std::set<std::string> names = kept_scores(goal);
  Json repeated = Json::object();
  for (int k = 0; k < kRepeatedScans; ++k) {
    const Outcome scan = outcome_of_scan(store, scene, wanted, k);
    if (on_scan) {
      on_scan(k, scan);
    }
    if (scan.is_failed) {
      return Json::object();
    }
    for (const std::string& name : names) {
      if (const auto found = scan.scores.find(name); found != scan.scores.end()) {
        repeated[name].push_back(found->second);
      }
    }
  }
  return repeated;
}

std::optional<Scores> rescored_trial(SceneStore& store,
                                     const Study& study,
                                     const Trial& trial,
                                     FreshOutcomes* fresh) {
  const SceneSettings scene = scene_with(study, overrides_of(study, trial.point));
  const WantedScores wanted = wanted_by(study.goal).with_whole_scan(kFreshParts);
  const auto start = std::chrono::steady_clock::now();
  Outcome outcome;
  try {
    outcome.scores = evaluate(store, rescoring_settings(scene), {}, wanted).scores;
  } catch (const ConfigError& error) {  // what a finer part or other noise makes impossible
    outcome = {.is_failed = true, .message = error.what()};
  }
  outcome.seconds = seconds_since(start);
  if (fresh != nullptr) {
    fresh->keep(rescored_label(scene), trial.number, outcome);
  }
  const bool is_judgeable = !outcome.is_failed && problem_with(study.goal, outcome.scores).empty();
  return is_judgeable ? std::optional(std::move(outcome.scores)) : std::nullopt;
}

}  // namespace glint
