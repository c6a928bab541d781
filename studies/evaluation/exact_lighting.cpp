// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/evaluation/exact_lighting.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "metrics/lighting_scores.h"
#include "metrics/scores.h"
#include "studies/evaluation/lighting_totals.h"
#include "studies/imaging/path_lights.h"

namespace glint {
namespace {

/// Each takes up to half a millisecond: the lights are built, and curved walls measured.
constexpr int kMaxCandidates = 12;

std::vector<std::string> names_in(const Goal& goal) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (is_of_lighting(name) && !is_bound(name)) {
      names.push_back(name);
    }
  };
  for (const Objective& objective : objectives_of(goal)) {
    add(objective.name);
  }
  for (const Constraint& constraint : goal.constraints) {
    add(constraint.name);
  }
  return names;
}

/// Reads each file once.
MeshLoader remembering_loader() {
  using Meshes = std::map<std::filesystem::path, std::vector<LightTriangle>>;
  return [meshes = std::make_shared<Meshes>()](const std::filesystem::path& file) {
    const auto found = meshes->find(file);
    return found != meshes->end() ? found->second
                                  : meshes->emplace(file, load_light_mesh(file)).first->second;
  };
}

}  // namespace

ExactScores exact_lighting(const Study& study) {
  ExactScores exact = {.names = names_in(study.goal), .max_candidates = kMaxCandidates};
  exact.at = [&study, load = remembering_loader()](const Point& point) {
    Scores scores;
    add_scores(scores, lighting_totals(scene_with(study, overrides_of(study, point)), load));
    return scores;
  };
  return exact;
}

}  // namespace glint
