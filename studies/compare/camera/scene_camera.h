// SPDX-License-Identifier: GPL-3.0-or-later
//
// The camera of a scene: from a calibration, and as it is written back.
#pragma once

#include <filesystem>

#include "core/pose.h"
#include "simulator/camera/pinhole_camera.h"
#include "studies/definition/scene.h"

namespace glint {

/// calibration.toml of `glint calibrate`: its camera, calibration and cell.
/// @throws ConfigError when it has no table [camera], IoError
SceneSettings read_calibrated_scene(const std::filesystem::path& file);

/// Puts "camera.focal_x_px" and so on into a scene, as intrinsics_of() has them.
void put_intrinsics(const PinholeIntrinsics& intrinsics, SceneSettings& scene);

/// The viewpoint of a camera_from_scene.
Viewpoint viewpoint_of_pose(const RigidTransform& camera_from_scene);

}  // namespace glint
