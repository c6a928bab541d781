// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "simulator/light/area/light_settings.h"
#include "simulator/light/area/lights.h"
#include "simulator/light/area/tunnel_light.h"

namespace glint {

/// A light and its name in the scene, which its groups carry on.
struct NamedLight {
  std::string name;
  LightSettings settings;
};

/// Where what lights may be fixed to stands in the scene.
struct LightMounts {
  RigidTransform scene_from_camera;
  RigidTransform scene_from_part;  ///< the part's pose
};

using LightTriangle = std::array<Eigen::Vector3d, 3>;  ///< mm, front side counterclockwise

/// Reads the triangles of a mesh emitter; given from outside, as lights know no meshes.
using MeshLoader = std::function<std::vector<LightTriangle>(const std::filesystem::path&)>;

/// Puts the lights of a scene where they stand.
///
/// Groups are numbered in the order of the lights; a light without separate_segments is one group
/// whose segment powers are in its radiances. The tunnel's groups, one for each bin of phases, come
/// last, from Lights::first_tunnel_group on.
/// @param mounts  where lights on the part and on the camera go
/// @throws ConfigError, IoError: a file that cannot be used, a light without luminous area, a
/// second environment
Lights build_lights(const std::vector<NamedLight>& lights,
                    const LightMounts& mounts,
                    const MeshLoader& load_mesh,
                    const std::optional<TunnelLight>& tunnel = {});

/// The frame of a light in the scene, wherever it is fixed: z the way it shines, x at roll 0
/// as close to the x axis of what it is fixed to as can be (y where it shines along x).
EmitterFrame placed_frame(const LightPlacement& placement, const LightMounts& mounts);

}  // namespace glint
