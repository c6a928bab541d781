// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/repeated_scores.h"

#include <set>

#include <nlohmann/json.hpp>

#include "studies/definition/render_methods.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::set<std::string> kept_scores(const Goal& goal) {
  std::set<std::string> names = {goal.objective.name, "defects.min_cnr"};
  for (const Constraint& constraint : goal.constraints) {
    names.insert(constraint.name);
  }
  return names;
}

}  // namespace

Json repeated_scores(SceneStore& store,
                     const SceneSettings& scene,
                     const WantedScores& wanted,
                     const Goal& goal) {
  const std::set<std::string> names = kept_scores(goal);
  WantedScores scan = wanted;
  scan.gradients = {};
  scan.errors = false;
  scan.defects = true;
  Json repeated = Json::object();
  for (int k = 0; k < kRepeatedScans; ++k) {
    scan.first_part = (k + 2) * kFreshParts;
    try {
      const Scores scores = evaluate(store, repeated_settings(scene, k), {}, scan).scores;
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
