// SPDX-License-Identifier: GPL-3.0-or-later
//
// [[viewpoint]] of a scene: as nine numbers, or as the pose of a robot's flange, which
// [calibration] and [cell] turn into nine numbers.
#pragma once

#include <string>
#include <vector>

#include "core/config/config.h"
#include "core/config/key_writer.h"
#include "studies/definition/scene.h"

namespace glint {

/// Reads the list of that name; camera, part, calibration and cell of the scene must have been
/// read.
void read_listed_viewpoints(const ConfigNode& root,
                            const std::string& name,
                            SceneSettings& scene,
                            std::vector<Problem>& errors);

/// The list as it is read again: poses of the flange as such.
ConfigNode write_listed_viewpoints(const SceneSettings& scene);

/// Rows of the key table.
std::vector<KeyRow> listed_viewpoint_keys();

/// Where the camera stands in the scene when the flange is there:
///   camera on the flange:    part_from_camera = inverse(base_from_part) base_from_flange
///                                               flange_from_camera
///   camera beside the robot: part_from_camera = inverse(flange_from_part)
///   inverse(base_from_flange)
///                                               base_from_camera
/// then scene_from_part, when the scene moves or turns its part.
/// @throws ConfigError for a table that is missing, with the key "base_from_flange"
RigidTransform scene_from_camera(const SceneSettings& scene, const PoseSettings& base_from_flange);

/// All viewpoints of the scene: listed, from a file, on a sphere, or along the part's surface.
/// @throws ConfigError beginning with the key at fault, IoError
std::vector<Viewpoint> viewpoints_of(const SceneSettings& scene, const Part& part);

}  // namespace glint
