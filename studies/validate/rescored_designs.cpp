// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/rescored_designs.h"

#include <optional>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/log.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/evaluation/evaluation.h"
#include "studies/validate/validated_scene.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// The objective of a scene; empty: it cannot be scored.
std::optional<double> objective_of(SceneStore& store,
                                   const SceneSettings& scene,
                                   const Goal& goal) {
  try {
    const Scores scores = evaluate(store, first_view(store, scene), {}, wanted_by(goal)).scores;
    const auto found = scores.find(goal.objective.name);
    return found == scores.end() ? std::nullopt : std::optional(found->second);
  } catch (const ConfigError& error) {
    log(LogLevel::kWarning, "a design cannot be scored again: {}", error.what());
    return std::nullopt;
  }
}

Json json_of(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// Keeps the best so far.
struct Leader {
  std::optional<double> value;
  std::string name;

  void see(const std::optional<double>& other, const std::string& by, bool is_maximised) {
    if (other && (!value || (is_maximised ? *other > *value : *other < *value))) {
      value = other;
      name = by;
    }
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
    const SceneSettings scene = read_design_scene(run / name / "scene.toml");
    const auto first = objective_of(store, scene, study.goal);
    const auto second = objective_of(store, refitted_scene(scene, refit), study.goal);
    before.see(first, name, study.goal.objective.is_maximised);
    after.see(second, name, study.goal.objective.is_maximised);
    rows.push_back({{"name", name}, {"before", json_of(first)}, {"after", json_of(second)}});
  }
  return {{"objective", study.goal.objective.name},
          {"designs", rows},
          {"winner_before", before.name},
          {"winner_after", after.name},
          {"changed", before.name != after.name}};
}

}  // namespace glint
