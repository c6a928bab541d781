// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hardware/planning/view_plan.h"
#include "studies/cell/cell_file.h"
#include "studies/definition/scene.h"

namespace glint {

/// The cell's own views in their order, from the first usable safe position and back to it:
/// straight in joints, over safe positions where the straight way is not free. Views and ways are
/// looked at as plan_views() does, among what planning_cell() holds where no part lies in the cell:
/// lights of a scene at the camera count. A view from which no way leads to that safe position is
/// not taken.
/// @param scene  whose lights are taken along; its calibration wins over the cell's; null: none
/// @throws ConfigError when no safe position is free, and as planning_cell()
ViewPlan plan_of_cell_views(const Cell& cell,
                            double speed_share,
                            const SceneSettings* scene = nullptr);

}  // namespace glint
