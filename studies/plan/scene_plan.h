// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hardware/planning/view_planner.h"
#include "studies/cell/cell_file.h"
#include "studies/definition/scene.h"

namespace glint {

/// A scene's views for a cell's arm, and what they were planned among.
struct ScenePlan {
  PlanningCell cell;
  ViewPlan plan;
};

/// What stands and is carried where a scene lies in its cell. Builds the part.
/// @throws ConfigError beginning with the key at fault, IoError
PlanningCell planning_cell_of(const SceneSettings& scene, const Cell& cell);

/// The plan of a scene's viewpoints. Builds the part; connects to nothing.
/// @throws ConfigError beginning with the key at fault, IoError
ScenePlan plan_scene(const SceneSettings& scene, const Cell& cell);

}  // namespace glint
