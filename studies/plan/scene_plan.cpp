// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/plan/scene_plan.h"

#include "studies/definition/scene_viewpoints.h"
#include "studies/imaging/built_part.h"
#include "studies/reach/scene_cell.h"

namespace glint {

PlanningCell planning_cell_of(const SceneSettings& scene, const Cell& cell) {
  return planning_cell(cell, scene, build_part_with_bvh(scene.part).part.mesh);
}

ScenePlan plan_scene(const SceneSettings& scene, const Cell& cell) {
  const BuiltPart built = build_part_with_bvh(scene.part);
  ScenePlan result = {.cell = planning_cell(cell, scene, built.part.mesh)};
  result.plan =
      plan_views(result.cell, view_requests(scene, cell, viewpoints_of(scene, built.part)));
  return result;
}

}  // namespace glint
