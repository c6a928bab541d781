// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "hardware/planning/planning_cell.h"
#include "hardware/planning/view_plan.h"

namespace glint {

/// What a path of a plan would touch in a cell, which need not be the one that it was planned for;
/// empty: nothing.
std::string obstruction(const PlanningCell& cell, const ViewPlan& plan);

}  // namespace glint
