// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/scene_scores.h"

#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "metrics/lighting_scores.h"
#include "metrics/scores.h"

namespace glint {

namespace {

/// The first environment among the lights; empty: there is none.
std::string environment_of(const std::vector<NamedLight>& lights) {
  const auto is_bright = [](double radiance) { return radiance > 0.0; };
  for (const NamedLight& light : lights) {
    const auto* environment = std::get_if<EnvironmentSettings>(&light.settings);
    if (environment != nullptr && std::ranges::any_of(environment->radiance, is_bright)) {
      return light.name;
    }
  }
  return "";
}

/// Whether the scene may come to move between the pictures of a scan.
bool moves(const SceneSettings& scene) {
  return scene.has_tunnel || scene.has_idle_tunnel;
}

}  // namespace

std::vector<std::string> defect_labels(const SceneSettings& scene) {
  std::vector<std::string> labels;
  for (const auto& [name, group] : scene.defects) {
    for (std::size_t i = 0; i < max_defects(group, scene.imprint); ++i) {
      labels.push_back(fmt::format("{}_{}", name, i + 1));
    }
  }
  return labels;
}

std::vector<std::string> group_names(const SceneSettings& scene) {
  std::vector<std::string> names;
  for (const auto& [name, group] : scene.defects) {
    names.push_back(name);
  }
  return names;
}

std::string missing_as_goal(std::string_view score) {
  return score == "rays.max_cells"
             ? "is reported only where it is below 16; it cannot be searched for"
             : "";
}

std::string missing_by_paths(const SceneSettings& scene, std::string_view score) {
  if (!needs_paths(scene)) {
    return "";
  }
  if (score.starts_with("rays.")) {
    return "counts the rays of a mirror-like part; this scene is path-traced and has no such score";
  }
  const bool is_of_tunnel = score.starts_with("view.") || needs_fringes(score);
  return is_of_tunnel && !scene.has_tunnel ? "needs a tunnel, this scene has none" : "";
}

std::string missing_by_reference(const SceneSettings& scene, std::string_view score) {
  const bool has_pictures = scene.reference && !scene.reference->pictures.empty();
  return is_of_reference(score) && !has_pictures
             ? "needs real pictures, which [reference] names; this scene has none"
             : "";
}

std::string missing_by_cell(const SceneSettings& scene, std::string_view score) {
  const bool has_cell = scene.cell && !scene.cell->file.empty();
  return is_of_reach(score) && !has_cell
             ? "needs the cell file of an arm, which cell.file names; this scene has none"
             : "";
}

std::string shining_environment(const SceneSettings& scene) {
  return environment_of(scene.lights);
}

std::string missing_by_lighting(const SceneSettings& scene,
                                std::string_view score,
                                bool with_idle) {
  const CostSettings cost = scene.cost.value_or(CostSettings{});
  if (score == "scan.time_s" && !cost.exposure_s) {
    return "needs cost.exposure_ms, how long one picture takes";
  }
  if (score == "scan.time_s" && !cost.move_s && moves(scene)) {
    return "needs cost.move_ms, how long the tunnel moves from one picture to the next";
  }
  if (score == "cost.total" && !cost.per_mm2 && !cost.per_led && !cost.per_frame) {
    return "needs a price: cost.per_mm2, cost.per_led or cost.per_frame";
  }
  if (!needs_light_size(score) && !(score == "cost.total" && cost.per_mm2)) {
    return "";
  }
  std::string environment = shining_environment(scene);
  if (environment.empty() && with_idle) {
    environment = environment_of(scene.idle_lights);
  }
  return environment.empty()
             ? ""
             : fmt::format(
                   "needs lights that have an end; lighting.{} is an environment, around "
                   "everything",
                   environment);
}

}  // namespace glint
