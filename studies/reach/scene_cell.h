// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scene in its cell: what stands where in the robot's base, and from where the camera shall look.
#pragma once

#include <vector>

#include "hardware/planning/planning_cell.h"
#include "hardware/planning/view_planner.h"
#include "studies/cell/cell_file.h"
#include "studies/definition/scene.h"

namespace glint {

/// The camera on the flange: the scene's own [calibration], else that of the file which the cell
/// names.
/// @throws ConfigError when neither tells it, or the camera stands beside the robot; IoError
MeasuredPoseSettings measured_flange_from_camera(const SceneSettings& scene, const Cell& cell);

/// The same pose. @throws as measured_flange_from_camera()
RigidTransform flange_from_camera(const SceneSettings& scene, const Cell& cell);

/// The scene's frame in the robot's base. @throws ConfigError without [cell.base_from_part]
RigidTransform base_from_scene(const SceneSettings& scene);

/// Arm, camera, cable and lights that the flange carries; obstacles, part and lights that stand.
/// @param part  the scene's, in its frame
/// @throws ConfigError beginning with the key at fault, IoError
PlanningCell planning_cell(const Cell& cell, const SceneSettings& scene, const TriangleMesh& part);

/// The viewpoints as they lie in the robot's base, "view_01" and so on.
/// @param viewpoints  viewpoints_of() the scene
/// @throws ConfigError as base_from_scene()
std::vector<ViewRequest> view_requests(const SceneSettings& scene,
                                       const std::vector<Viewpoint>& viewpoints);

Eigen::Isometry3d isometry_of(const RigidTransform& transform);

}  // namespace glint
