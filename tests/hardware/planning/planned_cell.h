// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hardware/planning/planning_cell.h"
#include "hardware/planning/view_planner.h"

namespace glint {

/// A UR3 over a table with a camera and a ring light on its flange, a ball of radius 40 mm at
/// (300, 0, 60) as the part, a post beside it, and two safe positions.
PlanningCell planned_cell();

/// Triangles of a ball by latitude and longitude.
TriangleMesh ball_mesh(const Eigen::Vector3d& centre_mm, double radius_mm, int rows);

/// A camera at a distance from a point that it looks at. @param towards  any length
Eigen::Isometry3d camera_looking(const Eigen::Vector3d& target_mm,
                                 const Eigen::Vector3d& towards,
                                 double distance_mm,
                                 double roll_rad = 0.0);

/// Views around the cell's part, random, the same for the same index.
ViewRequest random_view(std::uint64_t index);

}  // namespace glint
