// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/reach/reach_scores.h"

#include "studies/definition/scene_viewpoints.h"
#include "studies/reach/scene_cell.h"

namespace glint {

Scores reach_scores(SceneStore& store, const SceneSettings& scene) {
  if (!scene.cell || scene.cell->file.empty()) {
    throw ConfigError("cell.file", "is missing: the arm that takes the views");
  }
  const auto built = store.build(scene);
  const Cell cell = read_cell(scene.cell->file);
  const PlanningCell planned = planning_cell(cell, scene, built->part.mesh);
  const ViewPlan plan = plan_views(planned,
                                   view_requests(scene, cell, viewpoints_of(scene, built->part)),
                                   {.has_nearest = false});
  return {{"reach.share", plan.reach_share}, {"reach.margin_mm", plan.reach_margin_mm}};
}

}  // namespace glint
