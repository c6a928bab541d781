// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/scene_scores.h"

#include <fmt/format.h>

#include "metrics/scores.h"

namespace glint {

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
  return score == "rays.max_cells" ? "is told only where it is below 16; it cannot be searched for"
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

}  // namespace glint
