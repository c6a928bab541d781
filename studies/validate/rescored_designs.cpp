// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/rescored_designs.h"

#include <optional>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/log.h"
#include "optimizer/algorithm/merit.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/definition/scene_file.h"
#include "studies/evaluation/evaluation.h"
#include "studies/validate/validated_scene.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// What a design is chosen by.
struct Score {
  std::optional<double> objective;  ///< empty: it cannot be scored
  bool is_feasible = false;
};

Score score_of(SceneStore& store, const SceneSettings& scene, const Goal& goal) {
  try {
    const Scores scores = evaluate(store, first_view(store, scene), {}, wanted_by(goal)).scores;
    const auto found = scores.find(goal.objective.name);
    if (found == scores.end()) {
      return {};
    }
    return {.objective = found->second, .is_feasible = is_feasible(goal, scores)};
  } catch (const ConfigError& error) {
    log(LogLevel::kWarning, "a design cannot be scored again: {}", error.what());
    return {};
  }
}

Json json_of(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// Keeps the best so far: one that meets the limits before one that does not, as a search.
struct Leader {
  Score best;
  std::string name;

  void see(const Score& other, const std::string& by, bool is_maximised) {
    if (is_better(other, is_maximised)) {
      best = other;
      name = by;
    }
  }

  bool is_better(const Score& other, bool is_maximised) const {
    if (!other.objective || !best.objective) {
      return other.objective.has_value();
    }
    if (other.is_feasible != best.is_feasible) {
      return other.is_feasible;
    }
    return is_maximised ? *other.objective > *best.objective : *other.objective < *best.objective;
  }
};

}  // namespace

SceneSettings refitted_scene(const SceneSettings& scene, const DesignRefit& refit) {
  SceneSettings changed = changed_scene(scene, refit.change);
  // The part stays in the scene's frame, which everything else is told in: the camera moves.
  for (Viewpoint& viewpoint : changed.viewpoints) {
    viewpoint = viewpoint_of_pose(camera_from_world(viewpoint) * refit.scene_from_part);
  }
  return changed;
}

Json rescore_designs(SceneStore& store,
                     const Study& study,
                     const std::filesystem::path& run,
                     const std::vector<std::string>& designs,
                     const DesignRefit& refit) {
  if (!study.has_objective || has_several_objectives(study.goal)) {
    return nullptr;
  }
  Json rows = Json::array();
  Leader before;
  Leader after;
  for (const std::string& name : designs) {
    const SceneSettings scene = load_scene(run / name / "scene.toml");
    const Score first = score_of(store, scene, study.goal);
    const Score second = score_of(store, refitted_scene(scene, refit), study.goal);
    before.see(first, name, study.goal.objective.is_maximised);
    after.see(second, name, study.goal.objective.is_maximised);
    rows.push_back({{"name", name},
                    {"before", json_of(first.objective)},
                    {"after", json_of(second.objective)},
                    {"feasible_before", first.is_feasible},
                    {"feasible_after", second.is_feasible}});
  }
  return {{"objective", study.goal.objective.name},
          {"designs", rows},
          {"winner_before", before.name},
          {"winner_after", after.name},
          {"changed", before.name != after.name}};
}

}  // namespace glint
