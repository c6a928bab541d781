// SPDX-License-Identifier: GPL-3.0-or-later
//
// The lights of a scene at power 1, and what the powers of the scene make of them.
#pragma once

#include <string>
#include <vector>

#include "simulator/light/area/build_lights.h"
#include "simulator/material/local.h"
#include "studies/definition/scene.h"

namespace glint {

/// Lights whose radiance, scale and separate segments are 1; segments that are no groups of their
/// own keep their powers.
struct UnitLights {
  Lights lights;  ///< factors of all groups are 1
  /// Flux of each group with all segments at 1; of the three channels alike, 0 for an environment.
  std::vector<Colour> unit_power_w;
};

/// The scene's lights without their powers.
std::vector<NamedLight> without_powers(std::vector<NamedLight> lights);

/// The tunnel as its picture depends on it: the darkness of dark stripes is a factor.
TunnelSettings without_powers(TunnelSettings tunnel);

/// @throws ConfigError, IoError as build_lights()
UnitLights unit_lights(const SceneSettings& scene,
                       const RigidTransform& scene_from_camera,
                       const MeshLoader& load_mesh);

}  // namespace glint
