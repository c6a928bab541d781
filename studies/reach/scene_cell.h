// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scene in its cell: what stands where in the robot's base, what the flange carries, and from
// where the camera shall look. The flange carries the camera, or it holds the part up to a camera
// that stands beside the robot.
#pragma once

#include <optional>
#include <vector>

#include "hardware/planning/planning_cell.h"
#include "hardware/planning/view_planner.h"
#include "studies/cell/cell_file.h"
#include "studies/definition/scene.h"

namespace glint {

/// Where the camera is fixed, and where the part lies.
struct CellChain {
  bool is_in_hand = true;       ///< camera on the flange, part in the base; else the other way
  MeasuredPoseSettings camera;  ///< flange_from_camera, or base_from_camera
  MeasuredPoseSettings part;    ///< base_from_part, or flange_from_part
  RigidTransform carrier_from_camera;
  RigidTransform carrier_from_scene;

  RigidTransform scene_from_camera(const RigidTransform& base_from_flange) const;
};

/// The camera of the scene's own [calibration], else of the file that the cell names; the part of
/// the scene's [cell].
/// @throws ConfigError beginning with the key that is missing; IoError
CellChain cell_chain(const SceneSettings& scene, const Cell& cell);

/// Whether cell_chain() would find both.
bool has_cell_chain(const SceneSettings& scene, const Cell& cell);

/// Arm and what the flange carries: camera, cable and lights, or the part; what stands: obstacles,
/// and the others.
/// @param part  the scene's, in its frame
/// @throws ConfigError beginning with the key at fault, also for lights and tunnels of a scene that
///         the flange holds which stand in it; IoError
PlanningCell planning_cell(const Cell& cell, const SceneSettings& scene, const TriangleMesh& part);

/// The same where no part lies in the cell: arm, camera where a calibration has it, with the lights
/// of a scene that stand beside it, cable and bodies; obstacles. Lights that stand in the scene or
/// about the part, and all of them where nothing tells the camera, have to be among the cell's own
/// bodies and obstacles: nobody knows where they are.
/// @param scene  null: none; where its own [calibration] tells no camera, the file that the cell
///               names does
/// @throws ConfigError when the camera takes room and neither tells where it is; IoError
PlanningCell planning_cell(const Cell& cell, const SceneSettings* scene = nullptr);

/// The viewpoints as they lie in the robot's base, "view_01" and so on.
/// @param viewpoints  viewpoints_of() the scene
/// @throws ConfigError as cell_chain()
std::vector<ViewRequest> view_requests(const SceneSettings& scene,
                                       const Cell& cell,
                                       const std::vector<Viewpoint>& viewpoints);

Eigen::Isometry3d isometry_of(const RigidTransform& transform);

}  // namespace glint
