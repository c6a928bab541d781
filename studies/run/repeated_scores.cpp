// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/repeated_scores.h"

#include <set>

#include <nlohmann/json.hpp>

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
                     const Goal& goal) {
  const std::set<std::string> names = kept_scores(goal);
  Json repeated = Json::object();
  for (int k = 0; k < kRepeatedScans; ++k) {
    try {
      const Scores scores = repeated_scan(store, scene, wanted, k);
      for (const std::string& name : names) {
        if (const auto found = scores.find(name); found != scores.end()) {
          repeated[name].push_back(found->second);
        }
      }
    } catch (const ConfigError&) {
      return Json::object();
    }
  }
  return repeated;
}

}  // namespace glint
